"""Where the time goes: prepass, build, render."""
from matplotlib import pyplot as plt

from chart_style import INK, SOFT, name_of

# Parts in greys of the page, which report.py replaces. Not in hues: a hue stands for a sampler.
PARTS = [("prepassSeconds", "prepass", "#30363f"), ("buildSeconds", "build", "#8b939e"),
         ("renderSeconds", "render", "#d3d8de")]


def text_of(parts, limit):
    """The text beside a bar."""
    whole = sum(parts)
    share = 100 * (whole - parts[2]) / whole
    share_text = f"preparation {share:.2g} %" if share >= 0.1 else "preparation < 0.1 %" if share > 0 else "no preparation"
    return f"{whole:.3g} s, {share_text}" + (" (bar cut off)" if whole > limit * 1.001 else "")


def draw(results):
    rows = [(s, [s.get("overhead", key) or 0.0 for key, *_ in PARTS]) for s in results.samplers]
    rows = [(s, parts) for s, parts in rows if sum(parts) > 0]
    if not rows:
        return None
    others = [sum(parts) for s, parts in rows if not s.isOracle]
    longest = max(sum(parts) for _, parts in rows)
    limit = max(others) if others and longest > 1.5 * max(others) else longest
    texts = [text_of(parts, limit) for _, parts in rows]
    width, height = 6.6, 1.35 + 0.36 * len(rows)
    figure, ax = plt.subplots(figsize=(width, height))
    figure.subplots_adjust(left=0.02 + 0.0118 * max(len(name_of(s)) for s, _ in rows) + 0.03,
                           right=1 - (0.2 + 0.07 * max(len(t) for t in texts)) / width,
                           top=1 - 0.72 / height, bottom=0.46 / height)
    for y, ((s, parts), text) in enumerate(zip(rows, texts)):
        left = 0.0
        for (_, name, colour), seconds in zip(PARTS, parts):
            ax.barh(y, seconds, left=left, height=0.62, color=colour, linewidth=0,
                    label=name if y == 0 else None, gid=f"{name}-{s.index}")
            left += seconds
        ax.annotate(text, (min(left, limit), y), (6, 0), textcoords="offset points", va="center", fontsize=8.6,
                    color=INK, annotation_clip=False)
    ax.set_yticks(range(len(rows)), [name_of(s) for s, _ in rows], color=INK)
    ax.invert_yaxis()
    ax.set_xlim(0, limit)
    ax.grid(axis="y", visible=False)
    ax.spines["left"].set_visible(False)
    ax.set_xlabel("wall seconds")
    figure.text(0.02, 1 - 0.26 / height, "Where the time goes", fontsize=11.5, fontweight="bold")
    figure.legend(loc="upper left", bbox_to_anchor=(0.012, 1 - 0.30 / height), ncol=3, frameon=False, fontsize=8.8,
                  handlelength=1.1, handleheight=1.0, handletextpad=0.5, columnspacing=1.4, borderpad=0.2,
                  labelcolor=SOFT)
    return figure
