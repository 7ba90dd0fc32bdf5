"""Error against time and error against samples."""
import math

from matplotlib import pyplot as plt

import lab_results as lab
from chart_style import INK, PAPER, SOFT, log_ticks, name_of, spread_labels

AXES = {"seconds": ("Error against time", "wall seconds, preparation included"),
        "samples": ("Error against samples", "samples per pixel")}


def draw(results, axis):
    bands = [(s, lab.band(s.curves(axis))) for s in results.samplers]
    bands = [(s, b) for s, b in bands if b]
    if not bands:
        return None
    figure, ax = plt.subplots(figsize=(6.6, 4.5))
    figure.subplots_adjust(left=0.105, right=0.77, top=0.86, bottom=0.125)
    ax.set_xscale("log")
    ax.set_yscale("log")
    xs = [row[0] for _, b in bands for row in b]
    ys = [v for _, b in bands for row in b for v in row[1:]]
    xLow, xHigh = min(xs), max(xs)
    if xHigh < xLow * 1.5:
        xLow, xHigh = xLow / 1.5, xHigh * 1.5
    yLow, yHigh = min(ys) / 1.25, max(ys) * 1.25
    ax.set_xlim(xLow / 1.06, xHigh * 1.06)
    ax.set_ylim(yLow, yHigh)
    log_ticks(ax.xaxis, xLow / 1.06, xHigh * 1.06, doubling=axis == "samples")
    log_ticks(ax.yaxis, yLow, yHigh)
    draw_guide(ax, bands, axis)
    many = max(len(b) for _, b in bands) > 24
    for s, b in bands:
        x, mean, low, high = zip(*b)
        if any(h > l for l, h in zip(low, high)):
            ax.fill_between(x, low, high, color=s.colour, alpha=0.13, linewidth=0, gid=f"band-{s.index}")
        ax.plot(x, mean, color=s.colour, linestyle=s.dash, linewidth=2.4 if s.mayWin else 1.6, zorder=3,
                gid=f"line-{s.index}")
        shown = [-1] if many else range(len(x))
        ax.plot([x[i] for i in shown], [mean[i] for i in shown], linestyle="none", marker=s.marker, markersize=5.2,
                markerfacecolor=PAPER if s.biased else s.colour, markeredgecolor=s.colour if s.biased else PAPER,
                markeredgewidth=1.4 if s.biased else 0.7, zorder=4, gid=f"marks-{s.index}")
    label_ends(figure, ax, bands)
    title, xLabel = AXES[axis]
    ax.set_xlabel(xLabel)
    figure.text(0.02, 0.945, title, fontsize=11.5, fontweight="bold")
    band = "; band: lowest to highest seed" if any(len(s.curves(axis)) > 1 for s, _ in bands) else ""
    figure.text(0.02, 0.897, f"relL2, mean of {results.seeds_text()}{band}", fontsize=8.8, color=SOFT)
    return figure


def draw_guide(ax, bands, axis):
    """Slope -1: what independent samples achieve. Drawn above the ends of the curves, so that it crosses none there."""
    (xLow, xHigh), (yLow, yHigh) = ax.get_xlim(), ax.get_ylim()
    ends = [b[-1][1] * b[-1][0] for s, b in bands if not s.isOracle] or [b[-1][1] * b[-1][0] for _, b in bands]
    level = min(max(ends) * 1.9, xHigh * yHigh / 3)
    ax.plot([xLow, xHigh], [level / xLow, level / xHigh], color=SOFT, linewidth=1.0, linestyle=(0, (1, 2.2)), zorder=1,
            gid="guide")
    # Its name where the line is farthest from all curves.
    measured = [(math.log(r[0]), math.log(r[1])) for _, b in bands for r in b]
    best = None
    for t in range(8, 93, 3):
        x = math.exp(math.log(xLow) + t / 100 * math.log(xHigh / xLow))
        if not yLow * 1.2 < level / x < yHigh / 1.4:
            continue
        room = min(abs(math.log(x) - u) + abs(math.log(level / x) - v) for u, v in measured)
        if best is None or room > best[0]:
            best = (room, x)
    if best is None:
        return
    x = best[1]
    (x0, y0), (x1, y1) = ax.transData.transform([(x, level / x), (2 * x, level / (2 * x))])
    ax.text(x, level / x * 1.03, "∝ 1/" + ("time" if axis == "seconds" else "samples"), color=SOFT, fontsize=8.3,
            rotation=math.degrees(math.atan2(y1 - y0, x1 - x0)), rotation_mode="anchor", ha="center", va="bottom")


def label_ends(figure, ax, bands):
    """The names right of the axes, each tied to the end of its curve."""
    toAxes = ax.transData + ax.transAxes.inverted()
    ends = [toAxes.transform((b[-1][0], b[-1][1])) for _, b in bands]
    height = figure.get_figheight() * ax.get_position().height * 72
    gap = min(12.5 / height, 1.04 / len(bands))
    places = spread_labels([e[1] for e in ends], gap, -0.02, 1.02)
    for (s, _), (x, y), place in zip(bands, ends, places):
        ax.plot([x + 0.012, 1.012, 1.035], [y, y, place], color=s.colour, alpha=0.6, linewidth=0.8,
                linestyle="solid" if x > 0.9 else (0, (1, 3)), transform=ax.transAxes, clip_on=False,
                gid=f"tie-{s.index}")
        ax.text(1.045, place, name_of(s), transform=ax.transAxes, va="center", color=INK,
                fontsize=8.8 if len(s.label) < 17 else 7.2, gid=f"name-{s.index}")
