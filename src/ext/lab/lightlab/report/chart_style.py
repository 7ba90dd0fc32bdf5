"""The common style of all charts. The greys are agreed with report.py, which replaces them by the page's colours so that
the charts inside the page follow light and dark."""
import math

import matplotlib
from matplotlib.ticker import FixedLocator, NullFormatter, NullLocator

import lab_results as lab

INK = lab.INK
SOFT = "#5b636e"
GRID = "#e3e6ea"
PAPER = "#ffffff"


def apply():
    matplotlib.rcParams.update({
        "svg.fonttype": "none", "svg.hashsalt": "lightlab", "font.size": 9.5,
        "font.family": "sans-serif", "font.sans-serif": ["DejaVu Sans", "Helvetica", "Arial"],
        "text.color": INK, "axes.labelcolor": SOFT, "axes.edgecolor": SOFT, "xtick.color": SOFT, "ytick.color": SOFT,
        "axes.spines.top": False, "axes.spines.right": False, "axes.linewidth": 0.8,
        "axes.facecolor": "none", "figure.facecolor": PAPER, "savefig.facecolor": PAPER,
        "axes.grid": True, "grid.color": GRID, "grid.linewidth": 0.7, "axes.axisbelow": True,
        "axes.titlesize": 11, "axes.titleweight": "bold", "axes.titlelocation": "left", "axes.titlepad": 10,
        "xtick.major.size": 0, "ytick.major.size": 0, "xtick.minor.size": 0, "ytick.minor.size": 0,
        "xtick.major.pad": 6, "ytick.major.pad": 6, "lines.solid_capstyle": "round", "lines.dash_capstyle": "round",
    })


def plain(value):
    """0.002, 0.5, 20, 4000: readable on an axis."""
    return f"{value:.0f}" if value >= 1 and value == int(value) else f"{value:.10f}".rstrip("0").rstrip(".")


def log_ticks(axis, low, high, doubling=False):
    """1-2-5 ticks while they are few, else whole decades (doubling: powers of two); written out, not as powers."""
    first, last = math.floor(math.log10(low)) - 1, math.ceil(math.log10(high)) + 1
    for steps, most in (((1, 2, 5), 8), ((1, 3), 8), ((1,), 99)):
        ticks = ticks_of(steps, first, last, low, high)
        if len(ticks) <= most:
            break
    if len(ticks) < 3:
        ticks = ticks_of((1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8), first, last, low, high)
    if doubling:
        powers = [2.0 ** e for e in range(math.ceil(math.log2(low)), math.floor(math.log2(high)) + 1)]
        ticks = powers[::-1][::math.ceil(len(powers) / 8)][::-1] if len(powers) > 1 else ticks
    axis.set_major_locator(FixedLocator(ticks))
    axis.set_ticklabels([plain(t) for t in ticks])
    axis.set_minor_locator(NullLocator())
    axis.set_minor_formatter(NullFormatter())


def ticks_of(steps, first, last, low, high):
    ticks = [m * 10.0 ** e for e in range(first, last + 1) for m in steps]
    return [t for t in ticks if low * 0.999 <= t <= high * 1.001]


def spread_labels(wanted, gap, low, high):
    """Positions as near as possible to the wanted ones, at least gap apart, inside low..high; same order."""
    order = sorted(range(len(wanted)), key=lambda i: wanted[i])
    groups = []  # (sum of wanted start positions, members): neighbours that touch are pushed together as one block
    for i in order:
        groups.append([wanted[i], [i]])
        while len(groups) > 1 and start(groups[-1], gap) < start(groups[-2], gap) + len(groups[-2][1]) * gap:
            _, members = groups.pop()
            groups[-1][1] += members
            groups[-1][0] = sum(wanted[m] for m in groups[-1][1]) / len(groups[-1][1])
    placed = [0.0] * len(wanted)
    for g in groups:
        for k, i in enumerate(g[1]):
            placed[i] = start(g, gap) + (k + 0.5) * gap
    for previous, i in zip([None] + order, order):
        placed[i] = max(placed[i], low if previous is None else placed[previous] + gap)
    for following, i in zip([None] + order[::-1], order[::-1]):
        placed[i] = min(placed[i], high if following is None else placed[following] - gap)
    return placed


def start(group, gap):
    return group[0] - len(group[1]) * gap / 2


def name_of(sampler):
    """The label, with a note if the sampler is biased."""
    return sampler.label + (" (biased)" if sampler.biased else "")
