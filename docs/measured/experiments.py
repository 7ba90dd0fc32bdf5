"""What the scripts of docs/measured share: scenes, lightlab experiments, figures with their standard errors, CSV files."""
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "docs/results"))
import data  # noqa: E402

OURS = ["three-lights", "lamp-like", "hotel", "white-room", "ajar", "many-rooms", "one-light", "all-visible",
        "thin-walls", "slit", "glossy", "env-interior", "dollhouse"]
REAL = ["lamp", "veach-ajar"]
failed = []  # names of experiments that lightlab ended with an error


class Value:
    """A figure with its standard error."""

    def __init__(self, mean, error=0.0):
        self.mean, self.error = mean, error or 0.0

    def __truediv__(self, other):
        ratio = self.mean / other.mean
        return Value(ratio, abs(ratio) * math.hypot(self.error / self.mean, other.error / other.mean) if ratio else 0)

    def __str__(self):
        return f"{self.mean:.2f} +- {self.error:.2f}"


def geometric_mean(values):
    values = [v for v in values if v is not None]
    if not values:
        return None
    mean = math.exp(sum(math.log(v.mean) for v in values) / len(values))
    return Value(mean, mean * math.sqrt(sum((v.error / v.mean) ** 2 for v in values)) / len(values))


class Experiment:
    """results.json of lightlab.

    A sampler's relL2 holds the noise of the reference it is judged by; the samplers that made the references are judged
    by a noisier one. So that noise is taken off, except where it is most of the figure."""

    def __init__(self, file, noise=None):
        """`noise`: of a reference that was given to lightlab as a file."""
        self.noise = noise
        self.results = json.loads(pathlib.Path(file).read_text())
        self.samplers = {s["label"]: s for s in self.results["samplers"]}

    def summary(self, label):
        return self.samplers[label]["summary"]

    def error(self, label, metric="relL2"):
        s = self.samplers[label]
        m = s["summary"]["metrics"][metric]
        reference = self.results["references"][s["reference"]]
        noise = reference.get("noise") or self.noise or 0
        if metric == "relL2Trimmed":
            # Not recorded for references: as much of their noise as of the error of the sampler that made them.
            maker = self.samplers.get(reference.get("sampler"), s)["summary"]["metrics"]
            noise *= maker["relL2Trimmed"]["mean"] / maker["relL2"]["mean"] if maker["relL2"]["mean"] > 0 else 1
        return Value(m["mean"] - noise if noise < m["mean"] / 2 else m["mean"], m["standardError"])

    def spread(self, weights, metric="relL2"):
        """Standard error of the sum of weight * error over samplers, and its degrees of freedom. Runs of a seed share
        the camera's random numbers: from five seeds on they are compared one by one; fewer are taken for independent
        (Welch), as lightlab does (src/ext/lab/measures.h)."""
        runs = {k: [r["rounds"][-1]["metrics"][metric] for r in self.samplers[k]["runs"]] for k in weights}
        seeds = min(len(r) for r in runs.values())
        if seeds < 2:
            return 0.0, 0
        if self.is_paired():
            sums = [sum(w * runs[k][i] for k, w in weights.items()) for i in range(seeds)]
            return statistics.stdev(sums) / math.sqrt(seeds), seeds - 1
        variances = [w * w * statistics.variance(runs[k]) / seeds for k, w in weights.items()]
        fourth = sum(v * v for v in variances)
        return math.sqrt(sum(variances)), (seeds - 1) * sum(variances) ** 2 / fourth if fourth else 0

    def is_paired(self):
        return self.results["seeds"] >= 5

    def ratio(self, own, other, metric="relL2"):
        """Of two samplers' errors."""
        a, b = self.error(own, metric).mean, self.error(other, metric).mean
        return Value(a / b, a / b * self.spread({own: 1 / a, other: -1 / b}, metric)[0])

    def is_biased(self, label):
        return self.summary(label)["bias"]["verdict"] == "biased"

    def bias(self, label):
        """Verdict of the bias check, and the least bias that it would have detected: in the whole image, in a sixteenth
        of it, in a sixteenth at path vertices. None: unknown or more than all of the light."""
        b = self.summary(label)["bias"]
        sizes = b.get("visibleImage"), b.get("visibleSixteenth"), b.get("selection", {}).get("visibleSixteenth")
        return data.verdict(b["verdict"]), *(v if v is not None and v < 1 else None for v in sizes)

    def is_oracle(self, label):
        return self.samplers[label]["isOracle"]

    def best_other(self, own="octree", metric="relL2"):
        """Label of the least error among all but `own`, also with a guide, the oracle and biased samplers; None if there
        is none."""
        others = [k for k in self.samplers if k != own and not k.startswith(own + "+") and not self.is_oracle(k) and
                  not self.is_biased(k)]
        return min(others, key=lambda k: self.error(k, metric).mean, default=None)

    def preparation(self, label):
        overhead = self.summary(label)["overhead"]
        return overhead["prepassSeconds"] + overhead["buildSeconds"]


def add_arguments(parser, out, samples=None, scenes=None, seeds=3, divisor=2):
    """`samples`: default for scripts that only know equal samples."""
    parser.add_argument("--lightlab", default=str(ROOT / "build/release/src/pbrt/cmd/lightlab/lightlab"))
    if samples:
        parser.add_argument("--spp", type=int, default=samples, help=f"samples per pixel ({samples})")
    parser.add_argument("--reference-spp", type=int, help="samples per pixel of references (as lightlab likes)")
    parser.add_argument("--seeds", type=int, default=seeds, help=f"runs of every sampler ({seeds})")
    parser.add_argument("--divisor", type=int, default=divisor, help=f"divides the resolution ({divisor})")
    parser.add_argument("--threads", type=int, default=0, help="of lightlab (0: all cores)")
    parser.add_argument("--sampled-light", action="store_true",
                        help="lightlab's --sampled-light: without lights that the camera sees, and caustics")
    parser.add_argument("--only", help="scenes, comma list" + (f" ({','.join(scenes)})" if scenes else ""))
    parser.add_argument("--out", default=str(ROOT / out), help=f"folder of the experiments ({out})")
    parser.add_argument("--tables-only", action="store_true", help="measure nothing: read the results in --out")
    parser.add_argument("--csv", help="write the table to this CSV file as well; docs/results/make draws its chart")


def scene_folders():
    """Our scenes, and the real ones."""
    return ROOT / "scenes", pathlib.Path(os.environ.get("PBRT_REAL_SCENES") or ROOT.parent / "shared/scenes")


def scene_file(name):
    own, real = (folder / name / f"{name}.pbrt" for folder in scene_folders())
    return own if own.exists() else real


def all_scenes():
    """Names of all scenes present, ours first."""
    files = [f for folder in scene_folders() for f in sorted(folder.glob("*/*.pbrt"))]
    return list(dict.fromkeys(f.stem for f in files if f.stem == f.parent.name))


def run_lightlab(a, scene, out, samplers, more):
    """results.json, or None and a message. Resumes what the folder holds."""
    command = [a.lightlab, scene, "--samplers", ",".join(samplers), "--divisor", a.divisor, "--nthreads", a.threads,
               "--out", out, "--quiet", *more]
    out.parent.mkdir(parents=True, exist_ok=True)
    with open(f"{out}.txt", "w") as log:
        status = subprocess.run([str(c) for c in command], stdout=log).returncode
    if status == 0:
        return out / "results.json"
    print(f"*** {out.name}: lightlab ended with status {status} ***", flush=True)
    failed.append(out.name)
    return None


def run_experiment(a, name, samplers, spp=None, seconds=None, direct=True, report=False, judges=None, seeds=None):
    """`judges`: two samplers, the better of which makes one reference for all; without, no sampler is judged by its
    own, and so not all by the same. `seeds`: others than a.seeds. None, and a message, if the scene cannot be
    run."""
    scene, out, noise = scene_file(name), pathlib.Path(a.out) / name, None
    first = out.with_name(f"{name}-reference") / "results.json"
    if a.tables_only:
        if judges and first.exists():
            noise = json.loads(first.read_text())["references"][0].get("noise")
        found = Experiment(out / "results.json", noise) if (out / "results.json").exists() else None
        missing = [s for s in samplers if s not in found.samplers] if found else []
        if found and not missing:
            return found
        print(f"*** SKIPPED: no experiment of {name} {f'with {missing[0]} ' if missing else ''}in {a.out} ***", flush=True)
        return None
    if not scene.exists():
        print(f"*** SKIPPED: {name} is not there ({scene}) ***", flush=True)
        return None
    depth = (["--direct"] if direct else []) + (["--sampled-light"] if a.sampled_light else [])
    reference = ["--reference-spp", a.reference_spp] if a.reference_spp else []
    if judges:
        reference = reference or ["--reference-spp", max(512, 16 * spp)]
        first = run_lightlab(a, scene, out.with_name(f"{name}-reference"), judges,
                             ["--spp", 1, "--seeds", 1, "--no-report", *depth, *reference])
        if not first:
            return None
        noise = json.loads(first.read_text())["references"][0].get("noise")
        reference = ["--reference", first.parent / "reference-0.exr"]
    if getattr(a, "selection_work", None):
        depth += ["--selection-work", a.selection_work]
    more = ["--seeds", seeds or a.seeds, *(["--spp", spp] if spp else ["--time", seconds]), *depth, *reference]
    results = run_lightlab(a, scene, out, samplers, more if report else [*more, "--no-report"])
    return Experiment(results, noise) if results else None


def finish(a, head, rows, experiments):
    """Prints the table and writes it to --csv, with its origin. Returns the exit status: 1 if an experiment failed."""
    results = [e.results for e in experiments]
    machines = {str((r.get("machine") or {}).get("cpu") or "unknown") for r in results}
    seeds = ", ".join(map(str, sorted({r["seeds"] for r in results})))
    print(data.text(head, rows, {}))
    if a.csv:
        data.write(a.csv, head, rows, data.origin(results=results, machine=", ".join(sorted(machines)), seeds=seeds,
                                                  metric="relL2"))
    return 1 if failed else 0
