"""CSV files of measurements: lines `# key: value` that say how they were made, then a head and rows. Empty cell: unknown
or not applicable. What the columns mean: docs/results/summary.md."""
import csv
import datetime
import io
import math
import os
import pathlib
import shlex
import subprocess
import sys

TOP = pathlib.Path(__file__).resolve().parents[2]
# Folder of pbrt/pbrt, lightlab/lightlab and imgtool/imgtool; PBRT_BUILD names another build folder.
PROGRAMS = pathlib.Path(os.environ.get("PBRT_BUILD") or TOP / "build/release").resolve() / "src/pbrt/cmd"
VERDICTS = {"clean": "none detected"}  # of the lab's bias check; the others keep their names


def cell(value):
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else value


def verdict(word):
    return VERDICTS.get(word, word)


def origin(program=None, results=(), machine=None, **more):
    """Metadata of a table that the running script makes: `program` is pbrt, or `results` are those of lightlab."""
    if program and pathlib.Path(program).is_file():
        said = subprocess.run([str(program), "--version"], stdout=subprocess.PIPE, text=True).stdout
        results = [{"version": said.partition(" ")[2].partition(" ")[0], "commit": said.partition("(commit ")[2].partition(")")[0]}]
    script = pathlib.Path(sys.argv[0]).resolve()
    script = script.relative_to(TOP) if TOP in script.parents else script
    commit, version = (", ".join(sorted({r[k] for r in results if r.get(k)})) for k in ("commit", "version"))
    return {"commit": commit or "unknown", **({"version": version} if version else {}),
            "machine": machine or f"{processor()}, {os.cpu_count()} threads", "date": datetime.date.today().isoformat(),
            "command": shlex.join([str(script), *sys.argv[1:]]), **more}


def processor():
    try:
        text = pathlib.Path("/proc/cpuinfo").read_text()
        return next(line.partition(":")[2].strip() for line in text.splitlines() if line.startswith("model name"))
    except (OSError, StopIteration):
        return "unknown"


def text(head, rows, metadata):
    """`metadata`: of origin(), or any pairs of key and value."""
    out = io.StringIO()
    out.writelines(f"# {key}: {value}\n" for key, value in metadata.items())
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(head)
    writer.writerows([cell(value) for value in row] for row in rows)
    return out.getvalue()


def write(file, head, rows, metadata):
    pathlib.Path(file).write_text(text(head, rows, metadata), encoding="utf-8")


def read(file):
    """Rows as dictionaries of strings."""
    with open(file, newline="", encoding="utf-8") as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("# ")))


def number(row, column):
    """The number of a cell; None where it is empty."""
    text = row.get(column, "")
    return float(text) if text else None


def student_tail(t, dof, steps=2000):
    """Probability that Student's t exceeds this."""
    def integral(low):  # of the density with t = sqrt(dof) tan(angle), midpoint rule
        width = (math.pi / 2 - low) / steps
        return width * sum(math.cos(low + (i + .5) * width) ** (dof - 1) for i in range(steps))
    return integral(math.atan(t / math.sqrt(dof))) / integral(-math.pi / 2)
