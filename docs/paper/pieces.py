"""The figures and tables of the paper as rows of CSV files: HEAD and a function from outcomes to rows each."""
import math
import sys

import paper_numbers as paper
from experiments import SAMPLER_OF_T, TOP, lab, of_fig1, of_fig3, of_fig5, of_table2

sys.path.insert(0, str(TOP / "docs/results"))
import data

ERROR, TRIMMED = "relL2Abs", "relL2AbsTrimmed"  # the paper's relL2, with the absolute epsilon 0.01
OVER = 1.1  # times its budget: preparation and one sample took longer than allowed
DIVISORS = (32, 16, 8, 4, 2, 1)  # of the time: where Fig. 4 reads the error
SLACK = 1.4  # a run may end a little before or after its time, by whole samples

EQUAL_TIME = ["scene", "paper_scene", "sampler", "paper_name", "paper_relL2", "relL2Abs", "standard_error", "trimmed",
              "fireflies", "over_uniform", "paper_samples", "samples", "paper_seconds", "seconds", "over_budget", "bias"]
CLAIMS = ["claim", "place", "scene", "answer", "times", "answer_trimmed", "times_trimmed", "biased"]


def sampler_of(results, label):
    return next((s for s in results.samplers if s.label == label), None)


def order(results):
    """The paper's samplers first, in its order, then the others."""
    labels = list(paper.NAME_IN_PAPER)
    return sorted(results.samplers, key=lambda s: (labels.index(s.label) if s.label in labels else 99, s.index))


def errors(s):
    """Error, its standard error, trimmed error, whether fireflies decide."""
    if s is None:
        return [None] * 4
    return [s.error(ERROR), s.error(ERROR, "standardError"), s.error(TRIMMED), int(bool(s.summary.get("firefliesDecide")))]


def ratio(a, b, metric=ERROR):
    """Error of a over error of b; None if unknown."""
    x, y = a and a.error(metric), b and b.error(metric)
    return x / y if x is not None and y else None


def compare(lower, higher, metric=ERROR):
    """Is the first's error lower? "yes", "no" or "within noise" (two standard errors), and how many times lower."""
    a, b = lower.error(metric), higher.error(metric)
    if a is None or b is None:
        return "unknown", None
    spreads = [s.error(metric, "standardError") or 0 for s in (lower, higher)]
    times = b / a if a > 0 else None
    if abs(b - a) <= 2 * math.hypot(*spreads):
        return "within noise", times
    return ("yes" if a < b else "no"), times


def claims(outcomes, of_scene):
    """`of_scene`: the claims about a scene of the paper."""
    rows = []
    for o in outcomes:
        for claim in of_scene(o.experiment.scene.paperScene):
            pair = [sampler_of(o.results, label) for label in (claim.lower, claim.higher)]
            if None in pair:
                continue
            times = f" ({claim.factor:g} times)" if claim.factor else ""
            names = [paper.NAME_IN_PAPER[label] for label in (claim.lower, claim.higher)]
            rows.append([f"{names[0]} below {names[1]}{times}", claim.place, o.experiment.scene.name, *compare(*pair),
                         *compare(*pair, TRIMMED), ", ".join(s.label for s in pair if s.biased)])
    return rows


def equal_time(outcomes, numbers):
    """`numbers`: of a scene of the paper, the relL2 and the samples of Ours, and the seconds of its samplers."""
    rows = []
    for o in outcomes:
        scene, uniform = o.experiment.scene, sampler_of(o.results, paper.UNIFORM)
        relL2, spp, seconds = numbers(scene.paperScene)
        for s in order(o.results):
            ours, known = s.label == paper.OURS, s.label in paper.NAME_IN_PAPER
            late = (s.get("seconds") or 0) > OVER * o.results.data.get("budget", math.inf)
            rows.append([scene.name, scene.paperScene, s.label, paper.NAME_IN_PAPER.get(s.label),
                         relL2 if ours else None, *errors(s), ratio(s, uniform), spp if ours else None,
                         whole(s.get("samples")), seconds if known else None, s.get("seconds"), int(late),
                         data.verdict(s.verdict)])
    return rows


def whole(value):
    return None if value is None else round(value)


def settings(outcome):
    """How the experiment was run, and how its scene differs from the paper's."""
    d, scene = outcome.results.data, outcome.experiment.scene
    depth = "direct light only" if d.get("direct") else f"depth {d.get('maxDepth')}"
    noise = [lab.number(r.get("noise")) for r in outcome.results.references]
    noise = ", ".join(lab.figures(n, 2) for n in noise if n is not None)
    return (f"{outcome.results.budget_text()}, {outcome.results.seeds_text()}, "
            f"{' x '.join(str(v) for v in d.get('resolution') or ['?'])} pixels, {depth}; reference "
            f"{', '.join(str(r.get('samples') or '?') for r in outcome.results.references)} samples per pixel"
            + (f" (relL2 of its noise {noise})" if noise else "")
            + f"; for the paper's {scene.paperScene}: {scene.difference}")


def fig1(outcomes):
    return equal_time(outcomes, lambda scene: (None, None, paper.FIG1_SECONDS))


def fig1_claims(outcomes):
    return claims(outcomes, lambda scene: paper.FIG1_CLAIMS)


def fig3(outcomes):
    """The paper's relL2 is that of Table 2 at T = 4096; those of Fig. 3 stand only inside its picture."""
    return equal_time(outcomes, lambda scene: (paper.TABLE2[scene][4096].relL2, paper.TABLE1[scene].spp,
                                               paper.TABLE1[scene].total))


def fig3_claims(outcomes):
    return claims(outcomes, lambda scene: [*paper.FIG3_CLAIMS[scene], paper.LARGEST_GAIN])


def error_at(s, seconds):
    """Mean error over the seeds after so many seconds; None where some seed had no image yet."""
    found = []
    for points in s.curves("seconds", ERROR):
        if seconds < points[0][0] or seconds > points[-1][0] * SLACK:
            return None
        found.append(lab.interpolate(points, min(seconds, points[-1][0])))
    return sum(found) / len(found) if found else None


def fig4(outcomes):
    rows = []
    for o in outcomes:
        budget = lab.number(o.results.data.get("budget")) or 0
        rows += [[o.experiment.scene.name, s.label, paper.NAME_IN_PAPER.get(s.label), budget / d, error_at(s, budget / d)]
                 for s in order(o.results) for d in DIVISORS]
    return rows


def table1(outcomes):
    rows = []
    for o in outcomes:
        scene, t = o.experiment.scene, paper.TABLE1[o.experiment.scene.paperScene]
        rows.append([scene.name, "paper", t.spp, t.sampleGeneration, t.octreeBuilding, t.rendering, t.total,
                     (t.sampleGeneration + t.octreeBuilding) / t.total])
        for s in (sampler_of(o.results, label) for label in (paper.OURS, "octree")):
            if s:
                total = s.get("seconds")
                rows.append([scene.name, s.label, whole(s.get("samples")), s.get("overhead", "prepassSeconds"),
                             s.get("overhead", "buildSeconds"), s.get("overhead", "renderSeconds"), total,
                             overhead(s) / total if overhead(s) is not None and total else None])
    return rows


def overhead(s):
    """Seconds of sample generation and octree building."""
    parts = [s.get("overhead", k) for k in ("prepassSeconds", "buildSeconds")]
    return None if None in parts else sum(parts)


def table2(outcomes):
    """The last row of a scene is our own model, which takes no T."""
    rows = []
    for o in outcomes:
        numbers = paper.TABLE2[o.experiment.scene.paperScene]
        base = sampler_of(o.results, SAMPLER_OF_T[4096])
        for t, label in [*SAMPLER_OF_T.items(), (None, "octree")]:
            s, p = sampler_of(o.results, label), numbers.get(t)
            if s is None:
                continue
            size = s.get("bytes")
            before = lab.number((s.entry.get("report") or {}).get("leavesBeforePruning")) if t is None else None
            rows.append([o.experiment.scene.name, t, label, p and p.leaves, whole(s.get("leaves")), p and p.relL2, *errors(s),
                         p and p.relL2 / numbers[4096].relL2, ratio(s, base), p and p.kilobytes,
                         size / 1024 if size is not None else None, p and p.seconds, overhead(s), whole(before)])
    return rows


def fig5(outcomes):
    rows = []
    for o in outcomes:
        uniform = sampler_of(o.results, paper.UNIFORM)
        for s in order(o.results):
            p = paper.FIG5.get(s.label)
            rows.append([o.experiment.scene.name, s.label, paper.NAME_IN_PAPER.get(s.label), p, *errors(s),
                         p and p / paper.FIG5[paper.UNIFORM], ratio(s, uniform), ratio(s, uniform, TRIMMED),
                         data.verdict(s.verdict)])
    return rows


# Name on the command line: experiments, and of each CSV file its head and its rows.
PIECES = {
    "fig1": (of_fig1, {"fig1": (EQUAL_TIME, fig1), "fig1-claims": (CLAIMS, fig1_claims)}),
    "fig3": (of_fig3, {"fig3": (EQUAL_TIME, fig3), "fig3-claims": (CLAIMS, fig3_claims)}),
    "fig4": (of_fig3, {"fig4": (["scene", "sampler", "paper_name", "seconds", "relL2Abs"], fig4)}),
    "table1": (of_fig3, {"table1": (
        ["scene", "sampler", "samples", "sample_generation_seconds", "octree_building_seconds", "rendering_seconds",
         "total_seconds", "overhead_share"], table1)}),
    "table2": (of_table2, {"table2": (
        ["scene", "T", "sampler", "paper_leaves", "leaves", "paper_relL2", "relL2Abs", "standard_error", "trimmed",
         "fireflies", "paper_over_4096", "over_4096", "paper_kilobytes", "kilobytes", "paper_seconds", "seconds",
         "leaves_before_pruning"], table2)}),
    "fig5": (of_fig5, {"fig5": (
        ["scene", "sampler", "paper_name", "paper_relL2", "relL2Abs", "standard_error", "trimmed", "fireflies",
         "paper_over_uniform", "over_uniform", "over_uniform_trimmed", "bias"], fig5)}),
}
