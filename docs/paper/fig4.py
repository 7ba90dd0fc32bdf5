#!/usr/bin/python3
"""Fig. 4: error against time in the runs of Fig. 3."""
import sys

sys.dont_write_bytecode = True
import campaigns
import pages
import paper_numbers as paper
from campaigns import lab

NAME, TITLE = "fig4", "Fig. 4: convergence over time"
CAMPAIGNS = campaigns.of_fig3
DIVISORS = (32, 16, 8, 4, 2, 1)  # of the time: where the error is read
SLACK = 1.4  # a run may end a little before or after its time, by whole samples


def error_at(s, seconds):
    """Mean error over the seeds after so many seconds; None where some seed had no picture yet."""
    found = []
    for points in s.curves("seconds", pages.ERROR):
        if seconds < points[0][0] or seconds > points[-1][0] * SLACK:
            return None
        found.append(lab.interpolate(points, min(seconds, points[-1][0])))
    return sum(found) / len(found) if found else None


def page(folder, outcomes):
    intro = (f"The paper's curves {paper.NOT_IN_TEXT}. Its text says that the benefit of Ours is consistently "
             "maintained over time (Sect. 5). Preparation counts: – means that a sampler had no picture yet.")

    def section(o):
        budget = lab.number(o.results.data.get("budget")) or 0
        times = [budget / d for d in DIVISORS]
        errors = {s.label: [error_at(s, t) for t in times] for s in o.results.samplers}
        rows = [[f"`{s.label}`", pages.name_in_paper(s), *(pages.num(e) for e in errors[s.label])]
                for s in pages.order(o.results)]
        kept = []
        for other in (paper.UNIFORM, paper.SPATIAL, paper.NEEPP):
            ratios = [b / a if a and b else None
                      for a, b in zip(errors.get(paper.OURS, []), errors.get(other, []))]
            rows.append([f"*{paper.NAME_IN_PAPER[other]} over Ours*", "above 1 at all times",
                         *(f"*{pages.num(r, 2)}*" for r in ratios)])
            below = sum(r is not None and r > 1 for r in ratios)
            kept.append(f"{below} of {sum(r is not None for r in ratios)} times below {paper.NAME_IN_PAPER[other]}")
        heads = ["sampler", "in the paper", *(f"{pages.plain(round(t, 3))} s" for t in times)]
        return pages.section(pages.head(o), pages.settings_text(o), pages.table(heads, rows, left=2),
                             f"Ours is {', '.join(kept)}.", pages.why_text(o), pages.bias_text(o),
                             pages.links(folder, o, ("chart-error-time.svg",)))
    return pages.page(TITLE, intro, outcomes, section)


if __name__ == "__main__":
    import command_line
    command_line.main([sys.modules[__name__]])
