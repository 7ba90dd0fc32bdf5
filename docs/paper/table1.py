#!/usr/bin/python3
"""Table 1: where the time of Ours goes in the runs of Fig. 3."""
import sys

sys.dont_write_bytecode = True
import campaigns
import pages
import paper_numbers as paper

NAME, TITLE = "table1", "Table 1: breakdown of the rendering time"
CAMPAIGNS = campaigns.of_fig3
HEADS = ["scene", "sampler", "spp", "sample generation", "octree building", "rendering", "total",
         "overhead, share of total"]


def paper_row(scene):
    t = paper.TABLE1[scene]
    overhead = t.sampleGeneration + t.octreeBuilding
    return [f"{scene} (paper)", "Ours", t.spp, *(pages.plain(v) for v in
            (t.sampleGeneration, t.octreeBuilding, t.rendering, t.total)), pages.share(overhead / t.total)]


def our_row(o, label, note):
    s = pages.sampler_of(o.results, label)
    if s is None:
        return [f"{o.campaign.scene.name} (here)", f"`{label}`"] + [pages.MISSING] * 6
    prepass, build = s.get("overhead", "prepassSeconds"), s.get("overhead", "buildSeconds")
    total = s.get("seconds")
    part = (prepass + build) / total if None not in (prepass, build) and total else None
    return [f"{o.campaign.scene.name} (here)", f"`{label}`{note}", pages.whole(s.get("samples")), pages.num(prepass, 2),
            pages.num(build, 2), pages.num(s.get("overhead", "renderSeconds")), pages.num(total), pages.share(part)]


def page(folder, outcomes):
    low, high = paper.OVERHEAD_SHARE
    intro = (f"Seconds, all columns of the paper's table. The paper's overhead is {pages.share(low)} to "
             f"{pages.share(high)} of the total (Sect. 5). The overhead is fixed: a shorter render has a larger share.")

    def section(o):
        scene = o.campaign.scene.paperScene
        rows = [paper_row(scene), our_row(o, paper.OURS, ""), our_row(o, "octree", ", not in the paper")]
        return pages.section(pages.head(o), pages.settings_text(o), pages.table(HEADS, rows, left=2),
                             pages.why_text(o, ", with fewer samples in less time"),
                             pages.links(folder, o, ("chart-overhead.svg",)))
    return pages.page(TITLE, intro, outcomes, section)


if __name__ == "__main__":
    import command_line
    command_line.main([sys.modules[__name__]])
