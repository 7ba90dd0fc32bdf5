"""Reads OUT/results.json of lightlab (schema 2). Shared by charts, page and table: the colour of a sampler, its curves,
which samplers may win. Standard library only."""
import json
import math
import pathlib
import sys
import zlib

SCHEMA = 2
INK = "#1b1f24"  # oracle and text: the page replaces it by its own text colour

# Colour-blind safe (Okabe and Ito 2008, without the yellow that white paper swallows). A name has the same colour in
# every run, chart and page; shape and dash repeat the colour.
STYLES = {
    "octree": ("#d55e00", "o", "solid"),
    "bvh": ("#0072b2", "s", "solid"),
    "spatial": ("#009e73", "^", "solid"),
    "neepp": ("#cc79a7", "D", "solid"),
    "power": ("#56b4e9", "v", "solid"),
    "exhaustive": ("#e69f00", "P", "solid"),
    "uniform": ("#848b95", "X", "solid"),
    "oracle": (INK, "*", (0, (4, 2))),
}
OTHER_COLOURS = ["#882255", "#117733", "#332288", "#999933", "#661100", "#44aa99"]
OTHER_MARKERS = ["h", "<", ">", "p", "d", "8"]
# Further entries of the same light sampler (a sweep over parameters): mixed with white or black, other dashes.
VARIANT_MIXES = [0.0, 0.42, -0.35, 0.62, -0.55]
VARIANT_DASHES = [None, (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (6, 1.5, 1.2, 1.5)), (0, (2.5, 2.5))]
# Stops of the error pictures' colours, from 0 to "errorScale": those of src/pbrt/images/false_color.cpp.
ERROR_RAMP = ["#05051a", "#401a8c", "#0d73a6", "#26b34d", "#f2cc26", "#fffae6"]
ERROR_MEASURE = "|x − r| / √(r² + 0.01 m²) of the pixel, m the mean of r"


class ResultsError(Exception):
    """The folder cannot be reported on; the message is one sentence for the user."""


def number(value):
    """value as a finite float, or None."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        return None
    return float(value)


def mix(colour, amount):
    """colour moved towards white (amount > 0) or black (amount < 0)."""
    target = 255 if amount > 0 else 0
    parts = [int(colour[i:i + 2], 16) for i in (1, 3, 5)]
    return "#" + "".join(f"{round(c + (target - c) * abs(amount)):02x}" for c in parts)


class Sampler:
    """One entry of "samplers" with nulls and missing parts made harmless."""

    def __init__(self, entry, index):
        self.entry = entry
        self.index = index
        self.label = str(entry.get("label") or entry.get("lightSampler") or f"sampler {index + 1}")
        self.kind = str(entry.get("lightSampler") or self.label.split(":")[0])
        self.isOracle = bool(entry.get("isOracle"))
        self.summary = entry.get("summary") or {}
        self.verdict = (self.summary.get("bias") or {}).get("verdict") or "unknown"
        self.colour, self.marker, self.dash = INK, "o", "solid"

    @property
    def biased(self):
        return self.verdict == "biased"

    @property
    def mayWin(self):
        return not self.biased and not self.isOracle

    def get(self, *path):
        """A number of the summary by path, or None."""
        value = self.summary
        for key in path:
            value = value.get(key) if isinstance(value, dict) else None
        return number(value)

    def error(self, metric="relL2", part="mean"):
        return self.get("metrics", metric, part)

    def curves(self, axis, metric="relL2"):
        """One list of (x, error) per seed, x growing; axis: "seconds" or "samples"."""
        result = []
        for run in self.entry.get("runs") or []:
            points = []
            for r in run.get("rounds") or []:
                x, y = number(r.get(axis)), number((r.get("metrics") or {}).get(metric))
                if x is not None and y is not None and x > 0 and y > 0 and (not points or x > points[-1][0]):
                    points.append((x, y))
            if points:
                result.append(points)
        return result

    def time_at(self, samples):
        """Mean wall seconds the runs needed for that many samples per pixel; None if no run got there."""
        found = []
        for run in self.entry.get("runs") or []:
            points = [(number(r.get("samples")), number(r.get("seconds"))) for r in run.get("rounds") or []]
            value = interpolate([p for p in points if None not in p and min(p) > 0], samples)
            if value is not None:
                found.append(value)
        return sum(found) / len(found) if found else None

    def error_at(self, axis, x):
        """Mean error over the seeds at x; None if no run got there."""
        found = [v for v in (interpolate(c, x) for c in self.curves(axis)) if v is not None]
        return sum(found) / len(found) if found else None


def interpolate(points, x):
    """Straight line in log-log between points; None outside of them."""
    if not points or x < points[0][0] * (1 - 1e-6) or x > points[-1][0] * (1 + 1e-6):
        return None
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        if x <= x1:
            t = math.log(max(x, x0) / x0) / math.log(x1 / x0) if x1 > x0 else 1.0
            return math.exp(math.log(y0) + t * math.log(y1 / y0))
    return points[-1][1]


def band(curves, limit=80):
    """(x, mean, lowest, highest) over the seeds, at every x that some seed measured and all seeds cover."""
    if not curves:
        return []
    low, high = max(c[0][0] for c in curves), min(c[-1][0] for c in curves)
    if low > high:
        low, high = curves[0][0][0], curves[0][-1][0]
        curves = curves[:1]
    xs = []
    for x in sorted({x for c in curves for x, _ in c if low <= x <= high}):
        if not xs or x > xs[-1] * 1.02:
            xs.append(x)
    if xs and xs[-1] < high:
        xs[-1:] = [xs[-1], high] if high > xs[-1] * 1.02 else [high]
    if len(xs) > limit:
        xs = [math.exp(math.log(low) + i / (limit - 1) * math.log(high / low)) for i in range(limit)]
    rows = []
    for x in xs:
        values = [v for v in (interpolate(c, min(max(x, c[0][0]), c[-1][0])) for c in curves) if v is not None]
        rows.append((x, sum(values) / len(values), min(values), max(values)))
    return rows


def style_samplers(samplers):
    """Gives every sampler its colour, marker and dash."""
    seen = {}
    taken = set()
    for s in samplers:
        if s.kind not in seen:
            if s.kind not in STYLES:
                slot = zlib.crc32(s.kind.encode()) % len(OTHER_COLOURS)
                while slot in taken and len(taken) < len(OTHER_COLOURS):
                    slot = (slot + 1) % len(OTHER_COLOURS)
                taken.add(slot)
                seen[s.kind] = [(OTHER_COLOURS[slot], OTHER_MARKERS[slot], "solid"), 0]
            else:
                seen[s.kind] = [STYLES[s.kind], 0]
        (colour, s.marker, dash), variant = seen[s.kind]
        seen[s.kind][1] += 1
        amount = VARIANT_MIXES[variant % len(VARIANT_MIXES)]
        # The ink turns with the page; a mixed ink would not, so variants of the oracle keep it.
        s.colour = colour if colour == INK or amount == 0 else mix(colour, amount)
        s.dash = VARIANT_DASHES[(variant + variant // len(VARIANT_MIXES)) % len(VARIANT_DASHES)] or dash


class Results:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        file = self.folder / "results.json"
        try:
            self.data = json.loads(file.read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise ResultsError(f"{file} does not exist; lightlab --out writes it.") from None
        except (OSError, UnicodeDecodeError, json.JSONDecodeError) as e:
            raise ResultsError(f"{file} cannot be read: {e}.") from None
        if not isinstance(self.data, dict) or self.data.get("schema") != SCHEMA:
            found = self.data.get("schema") if isinstance(self.data, dict) else None
            raise ResultsError(f"{file} has schema {found}; this script reads schema {SCHEMA}.")
        self.samplers = [Sampler(e, i) for i, e in enumerate(self.data.get("samplers") or [])]
        if not self.samplers:
            raise ResultsError(f"{file} names no light sampler.")
        style_samplers(self.samplers)
        self.references = self.data.get("references") or []
        self.crops = self.data.get("crops") or []

    def ranked(self):
        """Samplers by final relL2, lowest first, those without one last."""
        return sorted(self.samplers, key=lambda s: (s.error() is None, s.error() or 0.0, s.index))

    @property
    def conclusion(self):
        """The conclusion of lightlab, shown unchanged: ext/lab/conclusion.h has the rules."""
        return self.data.get("conclusion") or {}

    def sentences(self):
        """The conclusion, headline first."""
        return [str(s) for s in self.conclusion.get("sentences") or ["Undecided: results.json holds no conclusion."]]

    def named(self, key):
        """The sampler that the conclusion names as "winner" or "lowestError", or None."""
        return next((s for s in self.samplers if s.label == self.conclusion.get(key)), None)

    def budget_text(self):
        budget = number(self.data.get("budget"))
        text = "?" if budget is None else f"{budget:g}"
        if self.data.get("mode") == "samples":
            return f"equal samples: {text} per pixel"
        return f"equal time: {text} s each"

    def seeds_text(self):
        seeds = self.data.get("seeds")
        return "1 seed" if seeds == 1 else f"{seeds} seeds"


def figures(value, digits=3):
    """A number with `digits` significant digits, without exponent where that is short; "–" for None."""
    if value is None:
        return "–"
    if value == 0:
        return "0"
    size = abs(value)
    if size >= 1e9 or size < 1e-6:
        return f"{value:.{digits - 1}e}"
    decimals = digits - 1 - math.floor(math.log10(size))
    return f"{value:,.{max(decimals, 0)}f}".replace(",", "\u202f") if size >= 10000 else f"{value:.{max(decimals, 0)}f}"


def program_text(data):
    """Version and commit of the program that wrote results.json."""
    commit = f"commit {data.get('commit') or 'unknown'}"
    return f"version {data['version']} ({commit})" if data.get("version") else commit


def main_with(action):
    """Runs action(folder) for `python3 script.py OUT`; a user's error is one sentence and exit status 1."""
    if len(sys.argv) != 2 or sys.argv[1] in ("-h", "--help"):
        script = pathlib.Path(sys.argv[0]).name
        print(f"usage: python3 {script} OUT    (OUT: lightlab's output folder)", file=sys.stderr)
        sys.exit(0 if sys.argv[-1] in ("-h", "--help") else 2)
    try:
        action(sys.argv[1])
    except ResultsError as e:
        print(f"{pathlib.Path(sys.argv[0]).name}: {e}", file=sys.stderr)
        sys.exit(1)
