#!/usr/bin/python3
"""Fig. 5: the failure case: light that arrives almost only indirectly."""
import sys

sys.dont_write_bytecode = True
import campaigns
import pages
import paper_numbers as paper

NAME, TITLE = "fig5", "Fig. 5: failure case"
CAMPAIGNS = campaigns.of_fig5
HEADS = ["sampler", "in the paper", "relL2, paper", "relL2Abs, here", "worst 0.1 % left out",
         "error over uniform's, paper", "error over uniform's, here", "worst 0.1 % left out", "bias check"]


def page(folder, outcomes):
    intro = (f"Equal samples: {paper.FIG5_SPP} per pixel in the paper, fewer here, so only the ratio to uniform can be "
             "compared. In the paper no sampler helps: the light lies behind the door.")

    def section(o):
        uniform = pages.sampler_of(o.results, paper.UNIFORM)
        rows = []
        for s in pages.order(o.results):
            p = paper.FIG5.get(s.label)
            rows.append([f"`{s.label}`", pages.name_in_paper(s), pages.plain(p), pages.error_text(s),
                         pages.num(s.error(pages.TRIMMED)),
                         pages.num(p / paper.FIG5[paper.UNIFORM]) if p else pages.MISSING,
                         pages.num(pages.ratio(s, uniform)), pages.num(pages.ratio(s, uniform, pages.TRIMMED)),
                         s.verdict])
        return pages.section(pages.head(o), pages.settings_text(o), pages.table(HEADS, rows, left=2),
                             pages.why_text(o, ", with fewer samples"), pages.bias_text(o),
                             pages.links(folder, o, ("chart-crops.png",)))
    return pages.page(TITLE, intro, outcomes, section)


if __name__ == "__main__":
    import command_line
    command_line.main([sys.modules[__name__]])
