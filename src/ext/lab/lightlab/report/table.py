"""The columns of the summary, for report.py's page and for OUT/table.md. Standard library only."""
import lab_results as lab
from lab_results import figures


class Column:
    """name: heading; value: sampler -> number, text or None (what sorting uses); show: how a cell reads; main: also in
    table.md and in print; better: which end is best ("low", "high" or "")."""

    def __init__(self, key, name, value, show=None, title="", group="", main=False, better=""):
        self.key, self.name, self.value, self.title, self.group = key, name, value, title, group
        self.main, self.better = main, better
        self.show = show or (lambda s: figures(value(s)))


def with_error(metric):
    def show(s):
        mean, error = s.error(metric), s.error(metric, "standardError")
        return figures(mean) + (f" ± {figures(error, 2)}" if mean is not None and len(s.entry.get("runs") or []) > 1 else "")
    return show


def speed_up(s):
    value = s.get("speedUp")
    return "–" if value is None else f"{figures(value)}×" + (f" {s.summary['speedUpAgainst']}"
                                                             if s.summary.get("speedUpAgainst") else "")


def share(*path):
    return lambda s: "–" if s.get(*path) is None else f"{100 * s.get(*path):.1f} %"


def signed_share(*path):
    return lambda s: "–" if s.get(*path) is None else f"{100 * s.get(*path):+.2f} %"


def whole(*path):
    return lambda s: "–" if s.get(*path) is None else f"{s.get(*path):,.0f}".replace(",", "\u202f")


def short(*path):
    """1.2 M instead of 1 200 000."""
    def show(s):
        v = s.get(*path)
        if v is None:
            return "–"
        for unit, size in (("G", 1e9), ("M", 1e6), ("k", 1e3)):
            if v >= size:
                return f"{figures(v / size)} {unit}"
        return figures(v)
    return show


def get(*path):
    return lambda s: s.get(*path)


def metric(name):
    return lambda s: s.error(name)


def trimmed(s):
    return with_error("relL2Trimmed")(s) + (" (fireflies decide)" if s.summary.get("firefliesDecide") else "")


COLUMNS = [
    Column("label", "sampler", lambda s: s.label, lambda s: s.label, main=True),
    Column("verdict", "bias", lambda s: {"clean": 0, "unknown": 1}.get(s.verdict, 2), lambda s: s.verdict,
           "verdict of the bias check: tile means against the reference", "trust", True),
    Column("relL2", "relL2", metric("relL2"), with_error("relL2"),
           "mean over seeds ± standard error of mean((x - r)² / (r² + 0.01 m²)), m the mean of r", "error", True, "low"),
    Column("relL2Trimmed", "relL2 trimmed", metric("relL2Trimmed"), trimmed,
           "trimmed relL2: without the 0.1 % of the pixels with the largest error", "error", True, "low"),
    Column("MSE", "MSE", metric("MSE"), with_error("MSE"), "mean squared error", "error", False, "low"),
    Column("MRSE", "MRSE", metric("MRSE"), with_error("MRSE"), "mean relative squared error", "error", False, "low"),
    Column("MAE", "MAE", metric("MAE"), with_error("MAE"), "mean absolute error", "error", False, "low"),
    Column("SMAPE", "SMAPE", metric("SMAPE"), with_error("SMAPE"), "symmetric mean absolute percentage error", "error",
           False, "low"),
    Column("FLIP", "FLIP", metric("FLIP"), with_error("FLIP"), "perceived difference when flipping between the images",
           "error", True, "low"),
    Column("samples", "samples", get("samples"), None, "mean samples per pixel", "speed", True),
    Column("seconds", "seconds", get("seconds"), None, "wall time, preparation included", "speed", True),
    Column("cpuSeconds", "CPU s", get("cpuSeconds"), None, "sum over threads", "speed"),
    Column("efficiency", "efficiency", get("efficiency"), None, "1 / (relL2 × seconds)", "speed", True, "high"),
    Column("speedUp", "speed-up", get("speedUp"), speed_up,
           "time the named sampler needs to reach the same error, over this sampler's time", "speed", True, "high"),
    Column("ratioToOracle", "x oracle", get("ratioToOracle"), None, "relL2 over the oracle's at equal samples", "speed",
           True, "low"),
    Column("prepass", "prepass s", get("overhead", "prepassSeconds"), None, "", "overhead", True),
    Column("build", "build s", get("overhead", "buildSeconds"), None, "", "overhead", True),
    Column("render", "render s", get("overhead", "renderSeconds"), None, "", "overhead"),
    Column("preparationShare", "share", get("preparationShare"), share("preparationShare"),
           "share of the preparation in the CPU time", "overhead"),
    Column("relativeCost", "cost", get("relativeCost"), None, "CPU time of a sample over that of the first sampler",
           "overhead"),
    Column("leaves", "leaves", get("leaves"), whole("leaves"), "", "structure", True),
    Column("bytes", "bytes", get("bytes"), whole("bytes"), "memory of the structure", "structure", True),
    Column("shadowRays", "shadow rays", get("shadowRays"), short("shadowRays"), "", "shadow rays"),
    Column("blockedShare", "blocked", get("blockedShare"), share("blockedShare"),
           "share of the shadow rays that are blocked", "shadow rays", True),
    Column("worstZ", "worst z", get("bias", "worstZ"), None,
           "standardised difference of the region with the smallest p-value", "bias check"),
    Column("pValue", "p", get("bias", "pValue"), None, "smallest p-value, corrected for all tests", "bias check"),
    Column("meanDifference", "mean diff.", get("bias", "meanDifference"), signed_share("bias", "meanDifference"),
           "relative difference of the whole image to the reference", "bias check"),
]


def best_of(column, samplers):
    """The samplers with the best value among those that may win, when more than one competes."""
    found = [(column.value(s), s) for s in samplers if s.mayWin and column.value(s) is not None]
    if not column.better or len(found) < 2:
        return []
    best = (min if column.better == "low" else max)(v for v, _ in found)
    return [s for v, s in found if v == best]


def markdown(results):
    columns = [c for c in COLUMNS if c.main and any(c.value(s) is not None for s in results.samplers)]
    winner = results.named("winner")
    lines = [f"**{escape(str(results.data.get('sceneName') or results.data.get('scene') or 'scene'))}**, "
             f"{results.budget_text()}, {results.seeds_text()}, {lab.program_text(results.data)}.", "",
             *(line for s in results.sentences() for line in (escape(s), "")),
             "| " + " | ".join(c.name for c in columns) + " |",
             "|" + "|".join("---" if c.key in ("label", "verdict") else "---:" for c in columns) + "|"]
    for s in results.ranked():
        cells = []
        for c in columns:
            text = escape(c.show(s))
            if c.key == "label":
                text += " (measuring instrument)" if s.isOracle else ""
            if c.key == "verdict" and s.biased:
                text = "**biased**"
            cells.append(f"**{text}**" if s is winner and c.key in ("label", "relL2") else text)
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def escape(text):
    return text.replace("\\", "\\\\").replace("|", "\\|").replace("*", "\\*").replace("<", "&lt;").replace("_", "\\_")
