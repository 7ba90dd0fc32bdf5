"""Speed against accuracy: a point per sampler after the same number of samples."""
import math

from matplotlib import pyplot as plt

from chart_style import INK, PAPER, SOFT, log_ticks, name_of

LAGGARD = 1 / 4  # share of the median number of samples; a sampler with fewer does not decide where all are compared


def last_samples(s):
    return max((c[-1][0] for c in s.curves("samples")), default=None)


def points_of(results):
    """(N, [(sampler, seconds, error)]) after N samples per pixel, where N is the most that every sampler but the
    oracle and laggards reached. Laggards are shown at their own last sample."""
    reached = sorted(n for n in (last_samples(s) for s in results.samplers if not s.isOracle) if n is not None)
    if not reached:
        return None, []
    common = next(n for n in reached if n >= LAGGARD * reached[len(reached) // 2])
    points = []
    for s in results.samplers:
        n = last_samples(s)
        at = common if n is None or n >= common or s.isOracle else n
        points.append((s, s.time_at(at), s.error_at("samples", at)))
    return common, [(s, t, e) for s, t, e in points if t and e]


def samples_text(n):
    return "1 sample" if n == 1 else f"{n:.4g} samples"


def front_of(points):
    """Unbiased samplers that no other unbiased one beats in both, by time. The oracle does not compete."""
    front = []
    for s, t, e in sorted((p for p in points if p[0].mayWin), key=lambda p: (p[1], p[2])):
        if not front or e < front[-1][2]:
            front.append((s, t, e))
    return front


def draw(results):
    common, points = points_of(results)
    if not points:
        return None
    figure, ax = plt.subplots(figsize=(6.6, 4.5))
    figure.subplots_adjust(left=0.105, right=0.96, top=0.86, bottom=0.125)
    ax.set_xscale("log")
    ax.set_yscale("log")
    times, errors = [t for _, t, _ in points], [e for _, _, e in points]
    xLow, xHigh, yLow, yHigh = min(times), max(times), min(errors), max(errors)
    xPad, yPad = max(1.25, (xHigh / xLow) ** 0.14), max(1.3, (yHigh / yLow) ** 0.12)
    limits = (xLow / xPad, xHigh * xPad ** 1.6, yLow / yPad, yHigh * yPad)
    ax.set_xlim(*limits[:2])
    ax.set_ylim(*limits[2:])
    log_ticks(ax.xaxis, *limits[:2])
    log_ticks(ax.yaxis, *limits[2:])
    draw_diagonals(ax, limits)
    front = front_of(points)
    if front:
        # The front itself is a staircase: between two of its members nothing better was measured.
        x = [v for s, t, e in front for v in (t, t)] + [limits[1]]
        y = [limits[3]] + [v for s, t, e in front for v in (e, e)]
        ax.plot(x, y, color=SOFT, linewidth=1.5, zorder=2, gid="front")
        ax.fill_between(x, y, [limits[3]] * len(x), color=SOFT, alpha=0.06, linewidth=0, zorder=0)
    for s, t, e in points:
        ax.plot([t], [e], marker=s.marker, markersize=12 if s.marker == "*" else 9.5, linestyle="none",
                markerfacecolor=s.colour if s.mayWin else PAPER, markeredgecolor=PAPER if s.mayWin else s.colour,
                markeredgewidth=1.0 if s.mayWin else 1.8, zorder=4, gid=f"point-{s.index}")
    place_names(figure, ax, points, list(zip(x, y)) if front else [], common)
    ax.set_xlabel(f"wall seconds for {samples_text(common)} per pixel, preparation included")
    figure.text(0.02, 0.945, "Speed against accuracy", fontsize=11.5, fontweight="bold")
    figure.text(0.02, 0.897, fontsize=8.8, color=SOFT,
                s=f"relL2 after {samples_text(common)} per pixel. Line: Pareto front. Dotted: equal error × time.")
    return figure


def draw_diagonals(ax, limits):
    """Lines of equal error x time: along one of them two samplers are equally good in equal time (error as 1/time)."""
    x0, x1, y0, y1 = limits
    low, high = math.log(x0 * y0), math.log(x1 * y1)
    count = 7
    for i in range(1, count):
        level = math.exp(low + (high - low) * i / count)
        ax.plot([x0, x1], [level / x0, level / x1], color=SOFT, linewidth=0.8, linestyle=(0, (1, 3)), alpha=0.6,
                zorder=1)


def place_names(figure, ax, points, front, common):
    """Beside the point, on the first of several sides where the name hits neither a point nor another name."""
    figure.canvas.draw()
    renderer = figure.canvas.get_renderer()
    marks = [ax.transData.transform((t, e)) for _, t, e in points]
    scale = figure.dpi / 72
    boxes = [(x - 6 * scale, y - 6 * scale, x + 6 * scale, y + 6 * scale) for x, y in marks]
    frame = ax.get_window_extent(renderer)
    corners = [ax.transData.transform(p) for p in front]
    lines = [(min(a[0], b[0]) - 1, min(a[1], b[1]) - 1, max(a[0], b[0]) + 1, max(a[1], b[1]) + 1)
             for a, b in zip(corners, corners[1:])]
    sides = [(9, 0, "left", "center"), (-9, 0, "right", "center"), (0, 8, "center", "bottom"), (0, -8, "center", "top"),
             (7, 7, "left", "bottom"), (7, -7, "left", "top"), (-7, 7, "right", "bottom"), (-7, -7, "right", "top"),
             (9, 15, "left", "bottom"), (9, -15, "left", "top")]
    for (s, t, e), mine in zip(points, list(boxes)):
        name = name_of(s) + (" (a floor, no competitor)" if s.isOracle else "")
        if last_samples(s) < common:
            name += f" (after {samples_text(last_samples(s))})"
        best = None
        for dx, dy, ha, va in sides:
            text = ax.annotate(name, (t, e), (dx, dy), textcoords="offset points", ha=ha, va=va, fontsize=9, color=INK,
                               zorder=5, gid=f"name-{s.index}")
            b = text.get_window_extent(renderer)
            cost = sum(overlap((b.x0, b.y0, b.x1, b.y1), other) for other in boxes + lines if other is not mine)
            cost += 4 * (max(0, frame.x0 - b.x0) + max(0, b.x1 - frame.x1) + max(0, frame.y0 - b.y0)
                         + max(0, b.y1 - frame.y1)) * 12
            if best is None or cost < best[0]:
                if best:
                    best[1].remove()
                best = (cost, text, (b.x0, b.y0, b.x1, b.y1))
            else:
                text.remove()
            if best[0] == 0:
                break
        boxes.append(best[2])


def overlap(a, b):
    return max(0.0, min(a[2], b[2]) - max(a[0], b[0])) * max(0.0, min(a[3], b[3]) - max(a[1], b[1]))
