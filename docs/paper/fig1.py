#!/usr/bin/python3
"""Fig. 1: equal time, three lights, direct light only."""
import sys

sys.dont_write_bytecode = True
import campaigns
import pages
import paper_numbers as paper

NAME, TITLE = "fig1", "Fig. 1: equal time, three lights, direct light only"
CAMPAIGNS = campaigns.of_fig1


def page(folder, outcomes):
    intro = (f"The paper renders {paper.FIG1_SECONDS} s with each sampler; its relL2 values {paper.NOT_IN_TEXT}. "
             "What the text says about the picture is checked below.")

    def section(o):
        seconds = {label: paper.FIG1_SECONDS for label in paper.NAME_IN_PAPER}
        return pages.section(pages.head(o), pages.settings_text(o), pages.error_table(o, {}, None, seconds),
                             pages.why_text(o), pages.bias_text(o), pages.claims_table(paper.FIG1_CLAIMS, [o]),
                             pages.links(folder, o, ("chart-crops.png", "chart-error-time.svg")))
    return pages.page(TITLE, intro, outcomes, section)


if __name__ == "__main__":
    import command_line
    command_line.main([sys.modules[__name__]])
