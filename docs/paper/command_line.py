"""What `run` and the single scripts do: read the options, run the campaigns, write the pages."""
import argparse
import pathlib
import shutil
import sys
import time

import campaigns
import pages
from campaigns import HERE, TOP, lab

ORDER = ["fig1", "fig3", "fig4", "table1", "table2", "fig5"]
KEPT = ["chart-error-time.svg", "chart-overhead.svg", "chart-crops.png", "results.csv", "rounds.csv"]


def parse(pieces):
    names = [p.NAME for p in pieces]
    about = ("Reproduces the figures and tables of the paper with lightlab; writes a page each and README.md with all."
             if len(pieces) > 1 else pieces[0].__doc__)
    parser = argparse.ArgumentParser(description=about, epilog="The same command goes on where an earlier one was "
                                     "stopped. Scenes outside the repository are skipped where absent.")
    effort = parser.add_mutually_exclusive_group()
    effort.add_argument("--quick", action="store_true", help="minutes on two cores (the default)")
    effort.add_argument("--full", action="store_true", help="hours on two cores")
    if len(pieces) > 1:
        parser.add_argument("--only", metavar="NAMES", help=f"comma list of {', '.join(names)}")
    parser.add_argument("--lightlab", metavar="PATH", help="the program (build/release, built if absent)")
    parser.add_argument("--out", metavar="FOLDER", type=pathlib.Path, help="build/paper/quick or build/paper/full")
    parser.add_argument("--scale", type=float, default=1, help="factor of all times and sample counts (1)")
    parser.add_argument("--divisor", type=int, default=1, help="of the resolution, beyond that of the effort (1)")
    parser.add_argument("--nthreads", type=int, default=0, help="of lightlab (0: all cores)")
    parser.add_argument("--restart", action="store_true", help="forget what the folder holds")
    parser.add_argument("--tables-only", dest="tablesOnly", action="store_true",
                        help="render nothing, write the pages from what is there")
    parser.add_argument("--keep", action="store_true", help="also write pages and charts to docs/paper/results")
    parser.add_argument("--results", type=pathlib.Path, default=HERE / "results", help="another folder for --keep")
    options = parser.parse_args()
    if options.scale <= 0:
        parser.error("--scale must be positive.")
    if options.divisor < 1:
        parser.error("--divisor must be at least 1.")
    wanted = names
    if len(pieces) > 1 and options.only is not None:
        wanted = [n.strip() for n in options.only.split(",")]
        if unknown := [n for n in wanted if n not in names]:
            parser.error(f"--only: {', '.join(unknown)} is unknown; choose from {', '.join(names)}.")
    options.out = (options.out or TOP / "build/paper" / ("full" if options.full else "quick")).resolve()
    return options, [p for p in pieces if p.NAME in wanted]


def collect(folder):
    """README.md of all pages in the folder."""
    found = [(n, folder / f"{n}.md") for n in ORDER if (folder / f"{n}.md").is_file()]
    parts = ["# The paper's figures and tables", "Written by `docs/paper/run`; do not edit. What the numbers mean is "
             "discussed in docs/paper/README.md of the repository."]
    for _, file in found:
        text = file.read_text(encoding="utf-8")
        # Headings one level down: this page has a title of its own.
        parts.append("\n".join("#" + line if line.startswith("#") else line for line in text.rstrip().splitlines()))
    (folder / "README.md").write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def write_pages(folder, pieces, outcomes):
    folder.mkdir(parents=True, exist_ok=True)
    for piece in pieces:
        text = piece.page(folder, [outcomes[c.name] for c in piece.CAMPAIGNS()])
        (folder / f"{piece.NAME}.md").write_text(text, encoding="utf-8")
    collect(folder)


def keep(options, pieces, outcomes):
    """Pages, charts and numbers into the repository's results folder; not the pictures. A piece with a failed campaign
    does not replace what was kept before."""
    def failed(piece):
        return any(o.problem and not o.skipped for o in (outcomes[c.name] for c in piece.CAMPAIGNS()))
    for piece in filter(failed, pieces):
        print(f"{piece.NAME}: not kept, because a campaign failed.", file=sys.stderr)
    pieces = [p for p in pieces if not failed(p)]
    for outcome in {c.name: outcomes[c.name] for p in pieces for c in p.CAMPAIGNS()}.values():
        target = options.results / outcome.campaign.name
        if outcome.results:
            target.mkdir(parents=True, exist_ok=True)
        for name in KEPT if outcome.results else []:
            (target / name).unlink(missing_ok=True)
            if (outcome.results.folder / name).is_file():
                shutil.copyfile(outcome.results.folder / name, target / name)
    write_pages(options.results, pieces, outcomes)


def main(pieces):
    options, pieces = parse(pieces)
    began = time.monotonic()
    try:
        options.lightlab = None if options.tablesOnly else campaigns.find_lightlab(options.lightlab)
        outcomes = {}
        for piece in pieces:
            for campaign in piece.CAMPAIGNS():
                if campaign.name not in outcomes:
                    outcomes[campaign.name] = campaigns.run(campaign, options)
            # Each page as soon as its campaigns are done.
            write_pages(options.out, [piece], outcomes)
            print((options.out / f"{piece.NAME}.md").read_text(encoding="utf-8"), flush=True)
    except campaigns.Interrupted:
        print("\nInterrupted. The same command goes on from there.", file=sys.stderr)
        sys.exit(130)
    except lab.ResultsError as e:
        print(f"{pathlib.Path(sys.argv[0]).name}: {e}", file=sys.stderr)
        sys.exit(1)
    if options.keep:
        keep(options, pieces, outcomes)
    problems = [o for o in outcomes.values() if o.problem]
    for o in problems:
        print(f"{o.campaign.name}: {o.problem}", file=sys.stderr)
    print(f"{len(outcomes) - len(problems)} of {len(outcomes)} campaigns, {time.monotonic() - began:.0f} s: "
          f"{options.out / 'README.md'}", file=sys.stderr)
    sys.exit(1 if any(not o.skipped for o in problems) else 0)
