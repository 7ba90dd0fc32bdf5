#!/usr/bin/env python3
"""One-line faults that the tests must notice. Each fault of faults.toml is put into the source, its test program is built
and must fail; then the source is restored. Prints a table and exits with status 1 if a fault goes unnoticed.

usage: sabotage.py BUILD_FOLDER [--only TEXT] [--csv FILE]
                             about a minute a fault; changes files of the checkout while it runs
       sabotage.py --check   every fault still fits exactly one place of the source
"""
import argparse
import csv
import re
import subprocess
import sys
import time
import tomllib
from pathlib import Path

TOP = Path(__file__).resolve().parents[3]


def read_faults():
    with open(Path(__file__).with_name("faults.toml"), "rb") as file:
        return tomllib.load(file)["fault"]


def check(fault):
    """What is wrong with the entry, or None."""
    path = TOP / fault["file"]
    if not path.is_file():
        return f"no file {fault['file']}"
    count = path.read_text().count(fault["from"])
    if count != 1:
        return f"{fault['file']} contains {fault['from']!r} {count} times, not once"
    program = fault["test"].split()[0].rsplit("/", 1)[1]
    lists = [path.read_text() for path in (TOP / "tests").rglob("CMakeLists.txt")]
    if not any(re.search(rf"\b{re.escape(name)}\b", text) for name in (program, program.removeprefix("unit_")) for text in lists):
        return f"no test program {program}"
    return None


def run(command, log, seconds):
    with open(log, "w") as file:
        try:
            return subprocess.run(command, cwd=TOP, stdout=file, stderr=subprocess.STDOUT, timeout=seconds).returncode
        except subprocess.TimeoutExpired:
            return "timeout"


def attempt(fault, build):
    """'noticed', or why not; and the tests that failed."""
    path = TOP / fault["file"]
    program, *arguments = fault["test"].split()
    log = build / "sabotage.log"
    original = path.read_text()
    try:
        path.write_text(original.replace(fault["from"], fault["to"]))
        if run(["cmake", "--build", build, "-j2", "--target", program.rsplit("/", 1)[1]], log, 1200) != 0:
            return "does not compile", []
        if run([build / program, *arguments], log, 600) == 0:
            return "NOT NOTICED", []
        # Without such a line the program crashed, or ran out of time.
        failed = re.findall(r"^\[  FAILED  \] (\w[\w/]*\.[\w/]+)", log.read_text(errors="replace"), re.M)
        return "noticed", list(dict.fromkeys(failed))
    finally:
        path.write_text(original)


class Table:
    """The results as CSV, written row by row."""

    def __init__(self, path):
        self.commit = subprocess.run(["git", "describe", "--always", "--dirty", "--exclude=*"], cwd=TOP,
                                     capture_output=True, text=True).stdout.strip()
        self.file = open(path, "w", newline="")
        self.row("fault", "result", "tests that failed", "seconds", "commit")

    def row(self, *cells):
        csv.writer(self.file, lineterminator="\n").writerow(cells)
        self.file.flush()

    def add(self, fault, result, failed, seconds):
        program = fault["test"].split()[0].rsplit("/", 1)[1]
        self.row(fault["what"], result, " ".join(failed) or (program if result == "noticed" else ""), f"{seconds:.0f}",
                 self.commit)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", nargs="?", type=lambda folder: Path(folder).resolve())
    parser.add_argument("--only", default="", metavar="TEXT", help="only faults with this text in their description")
    parser.add_argument("--csv", type=Path, metavar="FILE",
                        help="write the results there: fault, result, tests that failed, seconds with the build, commit")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    if not arguments.check and not arguments.build:
        parser.error("a build folder or --check is needed")
    faults = [fault for fault in read_faults() if arguments.only in fault["what"]]
    table = Table(arguments.csv) if arguments.csv and not arguments.check else None
    unnoticed = 0
    for fault in faults:
        result, failed, start = check(fault) or "ok", [], time.monotonic()
        if result == "ok" and not arguments.check:
            result, failed = attempt(fault, arguments.build)
        if table:
            table.add(fault, result, failed, time.monotonic() - start)
        unnoticed += result not in ("ok", "noticed")
        print(f"{fault['what']}: {result}", flush=True)
    print(f"{len(faults) - unnoticed} of {len(faults)} faults {'fit the source' if arguments.check else 'noticed'}")
    return 1 if unnoticed or not faults else 0


sys.exit(main())
