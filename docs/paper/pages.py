"""Markdown of the figures and tables: numbers, comparisons beyond noise, what all pages say alike."""
import math

import paper_numbers as paper
from campaigns import lab

CHARTS = [("chart-error-time.svg", "error against time"), ("chart-error-samples.svg", "error against samples"),
          ("chart-crops.png", "crops with errors"), ("chart-speed-accuracy.svg", "speed against accuracy"),
          ("chart-overhead.svg", "where the time goes"), ("report.html", "the whole run in one page"),
          ("results.csv", "all numbers")]
MISSING = "–"
ERROR, TRIMMED = "relL2Abs", "relL2AbsTrimmed"  # the paper's relL2, with the absolute epsilon 0.01
OVER = 1.1  # times its budget: preparation and one sample took longer than allowed


def num(value, digits=3):
    return lab.figures(value, digits)


def plain(value):
    """A number as the paper prints it; "–" for none."""
    return MISSING if value is None else f"{value:g}"


def whole(value):
    return MISSING if value is None else f"{value:.0f}"


def share(value):
    return MISSING if value is None else f"{100 * value:.3g} %"


def table(heads, rows, left=1):
    """A Markdown table; the first `left` columns to the left, the others to the right."""
    rule = ["---" if i < left else "---:" for i in range(len(heads))]
    return "\n".join("| " + " | ".join(str(c) for c in row) + " |" for row in [heads, rule, *rows])


def sampler_of(results, label):
    return next((s for s in results.samplers if s.label == label), None)


def order(results):
    """The paper's samplers first, in its order, then the others."""
    labels = list(paper.NAME_IN_PAPER)
    return sorted(results.samplers, key=lambda s: (labels.index(s.label) if s.label in labels else 99, s.index))


def name_in_paper(s):
    return paper.NAME_IN_PAPER.get(s.label, "not in the paper")


def error_text(s):
    """Mean, its standard error, and what must not be overlooked."""
    spread = s.error(ERROR, "standardError")
    text = num(s.error(ERROR)) + (f" ± {num(spread, 2)}" if spread else "")
    return text + (" (fireflies)" if s.summary.get("firefliesDecide") else "")


def ratio(a, b, metric=ERROR):
    """Error of a over error of b; None if unknown."""
    x, y = a and a.error(metric), b and b.error(metric)
    return x / y if x is not None and y else None


def compare(lower, higher, metric=ERROR):
    """Is the first's error lower? "yes", "no" or "within noise", and how many times lower it is."""
    a, b = lower.error(metric), higher.error(metric)
    if a is None or b is None:
        return "unknown", None
    spreads = [s.error(metric, "standardError") or 0 for s in (lower, higher)]
    times = b / a if a > 0 else None
    if abs(b - a) <= 2 * math.hypot(*spreads):
        return "within noise", times
    return ("yes" if a < b else "no"), times


def claim_answer(results, claim):
    """Does the claim hold here?"""
    lower, higher = sampler_of(results, claim.lower), sampler_of(results, claim.higher)
    if lower is None or higher is None:
        return "not run"
    answer, times = compare(lower, higher)
    text = f"{answer} ({num(times, 2)} times)" if times is not None else answer
    if lower.summary.get("firefliesDecide") or higher.summary.get("firefliesDecide"):
        answer, times = compare(lower, higher, TRIMMED)
        text += f"; without the worst 0.1 % of pixels: {answer} ({num(times, 2)} times)"
    biased = [s.label for s in (lower, higher) if s.biased]
    return text + (f"; BIASED: {', '.join(biased)}" if biased else "")


def claims_table(claims, outcomes):
    """One row a claim, one column a scene."""
    done = [o for o in outcomes if o.results]
    rows = []
    for claim in claims:
        times = f" ({claim.factor:g} times)" if claim.factor else ""
        rows.append([f"{paper.NAME_IN_PAPER[claim.lower]} below {paper.NAME_IN_PAPER[claim.higher]}{times}",
                     claim.place, *(claim_answer(o.results, claim) for o in done)])
    return table(["the paper says", "where", *(f"{o.campaign.scene.name}, here" for o in done)], rows, left=99)


def settings_text(outcome):
    """What was run, from the results themselves."""
    d = outcome.results.data
    size = " × ".join(str(v) for v in d.get("resolution") or ["?"])
    depth = "direct light only" if d.get("direct") else f"depth {d.get('maxDepth')}"
    noise = [lab.number(r.get("noise")) for r in outcome.results.references]
    noise = ", ".join(num(n, 2) for n in noise if n is not None)
    spp = ", ".join(str(r.get("samples") or "?") for r in outcome.results.references)
    return (f"{outcome.results.budget_text()}, {outcome.results.seeds_text()}, {size} pixels, {depth}; "
            f"reference {spp} samples per pixel" + (f" (relL2 of its noise {noise})" if noise else "")
            + f"; commit {d.get('commit') or 'unknown'}.")


def why_text(outcome, more=""):
    """One sentence: why the paper's numbers and ours differ."""
    machine = outcome.results.data.get("machine") or {}
    here = f"{machine.get('cpu') or 'another machine'}, {machine.get('threads') or '?'} threads"
    return (f"Why they differ: the paper's {outcome.campaign.scene.paperScene} on an {paper.MACHINE} at a "
            f"resolution it does not name, here {outcome.campaign.scene.difference}, on {here}{more}.")


def head(outcome):
    return f"## {outcome.campaign.scene.name} (paper: {outcome.campaign.scene.paperScene})"


def problem_text(outcome):
    return f"{head(outcome)}\n\n**{outcome.problem}.**"


def bias_text(outcome):
    """A sentence if a sampler is biased, else nothing."""
    biased = [s.label for s in outcome.results.samplers if s.biased]
    return f"**Biased by the lab's check: {', '.join(biased)}.**" if biased else ""


def links(folder, outcome, names=None):
    """Those of the lab's files that are there, relative to the page; charts shown, others linked."""
    lines, others = [], []
    for file, title in CHARTS:
        if not (folder / outcome.campaign.name / file).is_file():
            continue
        target = f"{outcome.campaign.name}/{file}"
        if names and file in names:
            lines.append(f"![{outcome.campaign.scene.name}: {title}]({target})")
        elif file.endswith((".html", ".csv")):
            others.append(f"[{title}]({target})")
    return "\n\n".join(lines + ([" · ".join(others)] if others else []))


def effort_text(outcomes):
    """The first lines of a page."""
    done = [o for o in outcomes if o.results]
    if not done:
        return "Nothing was run."
    divisor = max((o.results.data.get("settings") or {}).get("divisor", 1) for o in done)
    reduced = (f"The scene's resolution divided by {divisor}: fewer records a leaf than in the paper. Where times are "
               "short, preparation weighs more than in the paper, and close samplers may change places.\n\n")
    return (reduced if divisor > 1 else "") + (
        "± is the standard error over seeds; \"within noise\" means less than two of them apart. Bias check \"unknown\": "
        "too few data to see a bias of 3 %. relL2Abs is the paper's relL2, the mean of (x - r)^2 / (r^2 + 0.01); the "
        "charts show relL2, whose epsilon is 0.01 times the squared mean of r. (over): preparation and the first "
        "sample alone took longer than allowed.")


def error_table(outcome, paper_error, paper_spp=None, paper_seconds=None):
    """One row a sampler: errors, samples, time, bias verdict. paper_*: by label; None for none."""
    results = outcome.results
    uniform = sampler_of(results, paper.UNIFORM)
    allowed = OVER * results.data.get("budget", math.inf) if results.data.get("mode") == "time" else math.inf
    rows = []
    for s in order(results):
        over = (s.get("seconds") or 0) > allowed
        rows.append([f"`{s.label}`", name_in_paper(s), plain(paper_error.get(s.label)), error_text(s),
                     num(s.error(TRIMMED)), num(ratio(s, uniform), 2),
                     plain((paper_spp or {}).get(s.label)), whole(s.get("samples")),
                     plain((paper_seconds or {}).get(s.label)), num(s.get("seconds")) + (" (over)" if over else ""),
                     s.verdict])
    return table(["sampler", "in the paper", "relL2, paper", "relL2Abs, here", "worst 0.1 % left out",
                  "error over uniform's", "spp, paper", "spp, here", "s, paper", "s, here", "bias check"], rows, left=2)


def page(title, intro, outcomes, section, closing=""):
    """A page: one section a campaign."""
    parts = [f"# {title}", intro, effort_text(outcomes)]
    for o in outcomes:
        parts.append(section(o) if o.results else problem_text(o))
    if closing and any(o.results for o in outcomes):
        parts.append(closing)
    return "\n\n".join(p for p in parts if p) + "\n"


def section(*parts):
    return "\n\n".join(p for p in parts if p)
