#!/usr/bin/python3
"""Table 2: leaves, error, memory and overhead by the parameter T."""
import sys

sys.dont_write_bytecode = True
import campaigns
import pages
import paper_numbers as paper
from campaigns import lab

NAME, TITLE = "table2", "Table 2: granularity of the octree"
CAMPAIGNS = campaigns.of_table2
HEADS = ["T", "leaves, paper", "leaves, here", "relL2, paper", "relL2Abs, here", "worst 0.1 % left out",
         "error over that of T = 4096, paper", "here", "KB, paper", "KB, here", "overhead s, paper",
         "overhead s, here"]


def overhead(s):
    parts = [s.get("overhead", k) for k in ("prepassSeconds", "buildSeconds")]
    return None if None in parts else sum(parts)


def cells(s, base):
    """leaves, relL2, trimmed, over T = 4096, KB, seconds of a sampler here."""
    if s is None:
        return [pages.MISSING] * 6
    size = s.get("bytes")
    return [pages.whole(s.get("leaves")), pages.error_text(s), pages.num(s.error(pages.TRIMMED)),
            pages.num(pages.ratio(s, base)), pages.num(size / 1024 if size is not None else None),
            pages.num(overhead(s), 2)]


def pruning_text(o):
    """What our own model did instead of obeying T."""
    s = pages.sampler_of(o.results, "octree")
    before = lab.number((s.entry.get("report") or {}).get("leavesBeforePruning")) if s else None
    if before is None or s.get("leaves") is None:
        return ""
    kept = pages.whole(s.get("leaves"))
    return f"`octree` split the scene into {before:.0f} cells (first seed) and kept {kept} (mean)."


def page(folder, outcomes):
    intro = ("The overhead is sample generation and octree building. Here at equal samples, so that the error tells of "
             "the choice of lights only. The last row is our own model, which the paper does not have: it takes no T; "
             "it builds a deep tree of visibilities and prunes it while held-out records allow.")

    def section(o):
        numbers = paper.TABLE2[o.campaign.scene.paperScene]
        base = pages.sampler_of(o.results, campaigns.SAMPLER_OF_T[4096])
        rows = []
        for t, label in campaigns.SAMPLER_OF_T.items():
            p = numbers[t]
            here = cells(pages.sampler_of(o.results, label), base)
            rows.append([t, p.leaves, here[0], pages.plain(p.relL2), here[1], here[2],
                         pages.num(p.relL2 / numbers[4096].relL2), here[3], p.kilobytes, here[4],
                         f"{p.seconds:.2f}", here[5]])
        here = cells(pages.sampler_of(o.results, "octree"), base)
        none = pages.MISSING
        rows.append(["`octree`, not in the paper", none, here[0], none, here[1], here[2], none, here[3], none, here[4],
                     none, here[5]])
        return pages.section(pages.head(o), pages.settings_text(o), pages.table(HEADS, rows), pruning_text(o),
                             pages.why_text(o, "; a leaf of our tree is a 4-byte node and a row of cumulative sums, "
                                               "and fewer pixels give fewer records a leaf"),
                             pages.bias_text(o), pages.links(folder, o))
    return pages.page(TITLE, intro, outcomes, section)


if __name__ == "__main__":
    import command_line
    command_line.main([sys.modules[__name__]])
