"""The lightlab experiments behind the figures and tables: scenes, samplers, effort; and running them."""
import os
import pathlib
import signal
import subprocess
import sys
from dataclasses import dataclass

HERE = pathlib.Path(__file__).resolve().parent
TOP = HERE.parent.parent
sys.path.insert(0, str(TOP / "src/ext/lab/lightlab/report"))
import lab_results as lab  # noqa: E402

# The samplers of the paper, then the others.
PAPER_SAMPLERS = ["uniform+mesh", "spatial", "neepp", "octree:model=paper"]
EXTRA_SAMPLERS = ["power+mesh", "bvh", "bvh+mesh", "octree"]
# T = 4096 is the default, so that this row has the same label (and reference) as in Fig. 3.
SAMPLER_OF_T = {512: "octree:model=paper,leaves=512", 4096: "octree:model=paper",
                32768: "octree:model=paper,leaves=32768"}


@dataclass(frozen=True)
class Scene:
    name: str
    paperScene: str   # the one of the paper that it stands for
    difference: str   # how it differs from the paper's
    shared: bool = False

    def file(self):
        real = pathlib.Path(os.environ.get("PBRT_REAL_SCENES") or TOP.parent / "shared/scenes")
        return (real if self.shared else TOP / "scenes") / self.name / f"{self.name}.pbrt"


THREE_LIGHTS = Scene("three-lights", "three-light scene", "a room of our own with three lights in niches")
LAMP = Scene("lamp", "Lamp", "the paper's scene in Bitterli's edition without two meshes", shared=True)
LAMP_LIKE = Scene("lamp-like", "Lamp", "a scene of our own: a bulb inside a shade and a ceiling panel")
HOTEL = Scene("hotel", "Hotel", "a corridor with rooms of our own, nine mesh lights as in the paper's")
WHITE_ROOM = Scene("white-room", "Whiteroom", "a room of our own, eight area lights as in the paper's")
VEACH_AJAR = Scene("veach-ajar", "Veach-Ajar", "the paper's scene with two of three textures plain", shared=True)
AJAR = Scene("ajar", "Veach-Ajar", "a scene of our own with the light behind a door")


@dataclass(frozen=True)
class Effort:
    budget: float       # seconds, or samples per pixel
    seeds: int
    divisor: int        # of the resolution
    referenceSpp: int


@dataclass(frozen=True)
class Experiment:
    name: str
    scene: Scene
    samplers: tuple
    timed: bool
    quick: Effort
    full: Effort
    direct: bool = False


def of_fig1():
    return [Experiment("fig1-three-lights", THREE_LIGHTS, tuple(PAPER_SAMPLERS + EXTRA_SAMPLERS), True,
                     Effort(1, 2, 5, 512), Effort(20, 5, 1, 4096), direct=True)]


def of_fig3():
    """Fig. 4 and Table 1 use the same runs, as in the paper."""
    return [Experiment(f"fig3-{scene.name}", scene, tuple(PAPER_SAMPLERS + EXTRA_SAMPLERS), True,
                     Effort(1, 2, 5, 512), Effort(120, 3, 1, 2048))
            for scene in (LAMP, LAMP_LIKE, HOTEL, WHITE_ROOM)]


def of_table2():
    return [Experiment(f"table2-{scene.name}", scene, tuple([*SAMPLER_OF_T.values(), "octree"]), False,
                     Effort(32, 2, 5, 512), Effort(128, 3, 1, 1024))
            for scene in (LAMP, LAMP_LIKE, HOTEL, WHITE_ROOM)]


def of_fig5():
    return [Experiment(f"fig5-{scene.name}", scene, tuple([*PAPER_SAMPLERS, "bvh", "octree"]), False,
                     Effort(32, 2, 5, 512), Effort(128, 3, 1, 2048))
            for scene in (VEACH_AJAR, AJAR)]


@dataclass
class Outcome:
    """Results of an experiment, or the reason why there are none."""
    experiment: Experiment
    results: lab.Results | None = None
    problem: str = ""
    skipped: bool = False  # its scene does not belong to the repository and is absent


def command(experiment, options):
    """The lightlab command of an experiment."""
    effort = experiment.full if options.full else experiment.quick
    budget = effort.budget * options.scale
    # Fewer pixels leave time for more samples in the reference, up to what the effort wants.
    referenceSpp = effort.referenceSpp * min(max(1, options.scale), options.scale * options.divisor**2)
    budget = f"{budget:g}" if experiment.timed else str(max(1, round(budget)))
    arguments = [str(options.lightlab), str(experiment.scene.file()), "--samplers", ",".join(experiment.samplers),
                 "--time" if experiment.timed else "--spp", budget, "--seeds", str(effort.seeds),
                 "--divisor", str(effort.divisor * options.divisor),
                 "--reference-spp", str(max(1, round(referenceSpp))),
                 "--out", str(options.out / experiment.name)]
    if experiment.direct:
        arguments.append("--direct")
    if options.nthreads:
        arguments += ["--nthreads", str(options.nthreads)]
    if options.restart:
        arguments.append("--restart")
    return arguments


class Interrupted(Exception):
    pass


def call(arguments, stdout=None):
    """Exit status. The program runs in its own process group and gets SIGINT once per Ctrl-C: the first ends it in good
    order, the second at once."""
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.default_int_handler)
    process = subprocess.Popen(arguments, stdout=stdout, process_group=0)
    interrupted = False
    while True:
        try:
            status = process.wait()
            break
        except KeyboardInterrupt:
            interrupted = True
            process.send_signal(signal.SIGINT)
    if interrupted or status == 130:
        raise Interrupted
    return status


def find_lightlab(given):
    """Path of lightlab; it is built if no path is given and build/release has none."""
    if given:
        if not os.access(given, os.X_OK):
            raise lab.ResultsError(f"{given}: is not an executable program.")
        return pathlib.Path(given).resolve()
    program = TOP / "build/release/src/pbrt/cmd/lightlab/lightlab"
    if not program.exists():
        print("Building lightlab (some minutes; log in build/release.log)", file=sys.stderr)
        for step in ([".ci/install"], [".ci/build", str(TOP / "build/release"), "--", "lightlab"]):
            if call(["bash", str(TOP / step[0]), *step[1:]]) != 0:
                raise lab.ResultsError("lightlab could not be built.")
    return program


def run(experiment, options):
    """Runs or resumes the experiment, or (--tables-only) reads its results."""
    outcome = Outcome(experiment)
    folder = options.out / experiment.name
    if not options.tablesOnly:
        scene = experiment.scene.file()
        if not scene.is_file():
            outcome.skipped = experiment.scene.shared
            hint = " (PBRT_REAL_SCENES names another folder)" if experiment.scene.shared else ""
            outcome.problem = f"{'SKIPPED' if outcome.skipped else 'FAILED'}: {scene} is absent{hint}"
            print(outcome.problem, file=sys.stderr)
            return outcome
        arguments = command(experiment, options)
        print(f"\n{experiment.name}: {' '.join(arguments)}", file=sys.stderr, flush=True)
        folder.mkdir(parents=True, exist_ok=True)
        with open(folder / "lightlab.txt", "w", encoding="utf-8") as stdout:
            status = call(arguments, stdout)
        if status != 0:
            outcome.problem = f"FAILED: lightlab ended with status {status}"
            print(f"{experiment.name}: {outcome.problem}. If it refuses the folder because program or scene changed: "
                  "--restart begins again.", file=sys.stderr)
            return outcome
    try:
        outcome.results = lab.Results(folder)
    except lab.ResultsError as e:
        outcome.skipped = options.tablesOnly
        outcome.problem = f"{'NOT RUN' if options.tablesOnly else 'FAILED'}: {e}"
        print(f"{experiment.name}: {outcome.problem}", file=sys.stderr)
    return outcome
