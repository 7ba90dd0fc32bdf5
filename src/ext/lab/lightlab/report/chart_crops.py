"""Enlarged parts of the picture: reference, each sampler's result, its false-colour error."""
import re

from matplotlib import pyplot as plt
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.patches import Rectangle

import lab_results as lab
from chart_style import INK, PAPER, SOFT, name_of

FRAME = "#ffb000"
LEAST_WIDTH = 4.5  # inches: title and colour scale side by side


def load(results, name):
    """The picture, or None if there is none."""
    if not name or not (results.folder / name).is_file():
        return None
    try:
        return plt.imread(results.folder / name)
    except (OSError, SyntaxError, ValueError):
        return None


def draw(results):
    crops = [c for c in results.crops if all(isinstance(c.get(k), int) for k in ("x0", "y0", "x1", "y1"))]
    columns = []  # (title, sampler or None, result, error)
    for r in results.references[:1]:
        columns.append(("reference", None, load(results, r.get("picture")), None))
    for s in results.samplers:
        picture, error = load(results, s.entry.get("picture")), load(results, s.entry.get("errorPicture"))
        if picture is not None or error is not None:
            columns.append((name_of(s), s, picture, error))
    if not crops or len(columns) < 2:
        return None
    size = 1.25
    ratio = max((c["y1"] - c["y0"]) / max(c["x1"] - c["x0"], 1) for c in crops)
    rows = 2 * len(crops)
    lines = max(1 + (len(re.findall("[:,].", c[0])) if len(c[0]) > 16 else 0) for c in columns)
    width, height = max(size * len(columns) + 0.5, LEAST_WIDTH), size * min(ratio, 1.6) * rows + 1.13 + 0.12 * lines
    figure, grid = plt.subplots(rows, len(columns), figsize=(width, height), squeeze=False)
    figure.subplots_adjust(left=0.36 / width, right=1 - 0.12 / width, bottom=0.42 / height,
                           top=1 - (0.66 + 0.12 * lines) / height, wspace=0.05, hspace=0.05)
    for k, crop in enumerate(crops):
        box = (slice(crop["y0"], crop["y1"]), slice(crop["x0"], crop["x1"]))
        for j, (title, sampler, picture, error) in enumerate(columns):
            for ax, image in ((grid[2 * k][j], picture), (grid[2 * k + 1][j], error)):
                empty_axes(ax)
                if image is not None and image[box].size:
                    ax.imshow(image[box], interpolation="nearest", cmap="gray", aspect="equal")
                elif sampler is not None:
                    ax.text(0.5, 0.5, "no picture", ha="center", va="center", transform=ax.transAxes, fontsize=8,
                            color=SOFT)
            if k == 0:
                title = re.sub("([:,])(?=.)", r"\1\n", title) if len(title) > 16 else title
                grid[0][j].set_title(title, fontsize=9 if len(title) <= 18 else 7.6, pad=5, loc="center", color=INK,
                                     fontweight="bold" if sampler is None else "normal")
            if k == len(crops) - 1 and sampler is not None:
                grid[2 * k + 1][j].set_xlabel(f"relL2 {lab.figures(sampler.error())}", fontsize=8.6, color=INK,
                                              labelpad=5)
        overview(grid[2 * k + 1][0], columns[0][2], crop)
        grid[2 * k][0].set_ylabel(f"crop {crop.get('name', k + 1)}", fontsize=8.6, color=SOFT)
        grid[2 * k + 1][0].set_ylabel("error", fontsize=8.6, color=SOFT)
    figure.text(0.12 / width, 1 - 0.28 / height, "Crops and their errors", fontsize=11.5, fontweight="bold")
    figure.text(0.12 / width, 1 - 0.46 / height, f"error: {lab.ERROR_MEASURE}", fontsize=8, color=SOFT)
    figure.text(0.12 / width, 0.1 / height, fontsize=8, color=SOFT,
                s=f"relL2: whole image, mean of {results.seeds_text()}. Pictures: first seed.")
    draw_scale(figure, results, width, height)
    return figure


def draw_scale(figure, results, width, height):
    """What the colours of the errors mean."""
    most = lab.number(results.data.get("errorScale"))
    if most is None:
        return
    long, right, y = 1.2, width - 0.12, height - 0.30
    ax = figure.add_axes([(right - long) / width, y / height, long / width, 0.1 / height])
    empty_axes(ax)
    ax.imshow([[i / 255 for i in range(256)]], aspect="auto",
              cmap=LinearSegmentedColormap.from_list("error", lab.ERROR_RAMP))
    figure.text((right - long) / width, (y - 0.04) / height, "0", ha="left", va="top", fontsize=8)
    figure.text(right / width, (y - 0.04) / height, f"{lab.figures(most)}  and more", ha="right", va="top", fontsize=8)


def empty_axes(ax):
    ax.set_xticks([])
    ax.set_yticks([])
    ax.grid(False)
    for spine in ax.spines.values():
        spine.set_visible(False)


def overview(ax, image, crop):
    """Where the crop lies in the picture."""
    if image is None:
        return
    ax.imshow(image, aspect="equal", cmap="gray")
    ax.add_patch(Rectangle((crop["x0"] - 0.5, crop["y0"] - 0.5), crop["x1"] - crop["x0"], crop["y1"] - crop["y0"],
                           fill=False, edgecolor=FRAME, linewidth=1.4))
