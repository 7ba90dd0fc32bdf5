#!/usr/bin/python3
"""Fig. 3: equal-time comparison on Lamp, Hotel and Whiteroom."""
import sys

sys.dont_write_bytecode = True
import campaigns
import pages
import paper_numbers as paper

NAME, TITLE = "fig3", "Fig. 3: equal time, global illumination"
CAMPAIGNS = campaigns.of_fig3


def page(folder, outcomes):
    intro = (f"The paper's relL2 values {paper.NOT_IN_TEXT}; for Ours the value of Table 2 at "
             "T = 4096 stands beside ours, and samples and seconds are those of Table 1.")

    def section(o):
        scene = o.campaign.scene.paperScene
        ours, times = paper.TABLE2[scene][4096], paper.TABLE1[scene]
        seconds = {label: times.total for label in paper.NAME_IN_PAPER}
        return pages.section(pages.head(o), pages.settings_text(o),
                             pages.error_table(o, {paper.OURS: ours.relL2}, {paper.OURS: times.spp}, seconds),
                             pages.why_text(o), pages.bias_text(o),
                             pages.claims_table(paper.FIG3_CLAIMS[scene], [o]),
                             pages.links(folder, o, ("chart-crops.png",)))
    return pages.page(TITLE, intro, outcomes, section,
                      "## The largest gain\n\n" + pages.claims_table([paper.LARGEST_GAIN], outcomes)
                      + "\n\nThe paper's factor is that of one of its scenes; ours depends on how well 16 voxels along "
                        "the longest axis (`neepp:voxels`) catch the walls of the scene.")


if __name__ == "__main__":
    import command_line
    command_line.main([sys.modules[__name__]])
