"""Images side by side, each with a label above it and white between them."""
import pathlib

GAP, LINE, INK = 6, 18, "#1b1f24"


def sheet(panes, labels, across):
    """Panes of one size in rows of so many."""
    from matplotlib import get_data_path
    from PIL import Image, ImageDraw, ImageFont
    font = ImageFont.truetype(str(pathlib.Path(get_data_path()) / "fonts/ttf/DejaVuSans.ttf"), 12)
    width, height = panes[0].size
    down = (len(panes) + across - 1) // across
    image = Image.new("RGB", (across * (width + GAP) - GAP, down * (height + LINE + GAP) - GAP), "white")
    draw = ImageDraw.Draw(image)
    for i, (pane, label) in enumerate(zip(panes, labels)):
        x, y = i % across * (width + GAP), i // across * (height + LINE + GAP)
        draw.text((x + 1, y + 1), label, INK, font)
        image.paste(pane, (x, y + LINE))
    return image
