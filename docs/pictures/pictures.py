"""What the scripts of docs/pictures share: a scene at another size, a render of it, and a JPEG at a sensible exposure."""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
TOP = HERE.parent.parent
# A picture is as bright as on lightlab's page: the median luminance becomes mid grey, but three quarters of the pixels
# stay below white.
MID_GREY, BELOW_WHITE = 0.18, 0.75
LUMINANCE = (0.2126, 0.7152, 0.0722)
QUALITY = 86


def programs(build):
    """Paths of pbrt, imgtool and lightlab in a build folder."""
    folder = build.resolve() / "src/pbrt/cmd"
    return {name: folder / name / name for name in ("pbrt", "imgtool", "lightlab")}


def call(*command, text=None, cwd=None, statuses=(0,)):
    """Runs a program and returns what it printed; ends with a message if its exit status is another."""
    done = subprocess.run([str(c) for c in command], input=text, cwd=cwd, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True)
    if done.returncode not in statuses:
        sys.exit(f"{' '.join(str(c) for c in command)}\nended with status {done.returncode}:\n{done.stdout}")
    return done.stdout


def resized(scene, width, most=None, portal=None):
    """The text of a scene with another resolution; to be rendered from the scene's folder. No sample is brighter than
    most, and the infinite light has this portal, if they are given."""
    text = scene.read_text()
    sizes = {axis: re.search(rf'("integer {axis}resolution" *\[? *)(\d+)', text) for axis in "xy"}
    if not all(sizes.values()):
        sys.exit(f"{scene}: no xresolution and yresolution found")
    height = max(1, round(int(sizes["y"].group(2)) * width / int(sizes["x"].group(2))))
    for axis, pixels in (("x", width), ("y", height)):
        text = re.sub(rf'("integer {axis}resolution" *\[? *)\d+', rf"\g<1>{pixels}", text, count=1)
    if most is not None:
        text = re.sub(r'("integer xresolution")', rf'"float maxcomponentvalue" {most:.6g} \g<1>', text, count=1)
    if portal:
        text, found = re.subn(r'(LightSource "infinite")', rf'\g<1> "point3 portal" [ {portal} ]', text, count=1)
        if not found:
            sys.exit(f"{scene}: no infinite light for a portal")
    return text


def render(tools, scene, width, out, *flags, most=None, portal=None):
    """Renders a scene at this width into an EXR."""
    call(tools["pbrt"], "--quiet", "--outfile", out, *flags, "-", text=resized(scene, width, most, portal), cwd=scene.parent)


def pixels(tools, exr, channel=None):
    """Height x width x 3 values of a picture, or height x width x 1 of one of its channels."""
    import numpy
    magic, depth = (b"Pf", 1) if channel else (b"PF", 3)
    with tempfile.TemporaryDirectory() as folder:
        pfm = pathlib.Path(folder) / "out.pfm"
        call(tools["imgtool"], "convert", exr, pfm, *(["--channels", channel] if channel else []))
        with open(pfm, "rb") as file:
            if file.readline().strip() != magic:
                sys.exit(f"{exr}: not a colour picture")
            width, height = (int(n) for n in file.readline().split())
            order = "<" if float(file.readline()) < 0 else ">"
            values = numpy.frombuffer(file.read(), order + "f4", width * height * depth)
    return values.reshape(height, width, depth)[::-1]


def exposure(values, below_white=BELOW_WHITE):
    """The factor that makes a picture visible; this part of its lit pixels stays below white."""
    import numpy
    luminance = values @ numpy.array(LUMINANCE)
    lit = luminance[luminance > 0]
    if not lit.size:
        return 1.0
    return float(min(MID_GREY / numpy.median(lit), 1 / max(numpy.quantile(lit, below_white), 1e-30)))


def shown(values, factor):
    """A picture for the screen."""
    import numpy
    from PIL import Image
    v = numpy.clip(values * factor, 0, 1)
    v = numpy.where(v <= 0.0031308, 12.92 * v, 1.055 * v ** (1 / 2.4) - 0.055)
    return Image.fromarray((v * 255 + 0.5).astype("uint8"))


def error(tools, picture, reference):
    """relL2."""
    # The exit status is 1 where pictures differ.
    text = call(tools["imgtool"], "diff", "--json", "--metric", "relL2", "--reference", reference, picture, statuses=(0, 1))
    try:
        return json.loads(text)["error"]
    except ValueError:
        sys.exit(f"{picture}: cannot be compared with {reference}: {text}")


def panels(images, crop=(0.5, 0.5), zoom=3, brightness=1.0):
    """Labelled images of one size side by side at the exposure of the last one times `brightness`, below each the part around the point
    `crop` (fractions), enlarged. `images`: of label and pixels."""
    from PIL import Image
    sys.path.insert(0, str(TOP / "docs/method"))
    import sheet
    factor = brightness * exposure(images[-1][1])
    panes = [shown(values, factor) for _, values in images]
    labels = [label for label, _ in images]
    if zoom > 1:
        width, height = panes[0].size
        across, down = width // zoom, height // zoom // 2
        x, y = (min(max(round(c * size - part / 2), 0), size - part)
                for c, size, part in zip(crop, (width, height), (across, down)))
        # Panes of a sheet have one size: the crops of a sheet of their own.
        crops = [pane.crop((x, y, x + across, y + down)).resize((across * zoom, down * zoom), Image.NEAREST) for pane in panes]
        upper = sheet.sheet(panes, labels, len(panes))
        lower = sheet.sheet(crops, [f"{zoom} times enlarged"] * len(crops), len(crops))
        image = Image.new("RGB", (upper.width, upper.height + lower.height + sheet.GAP), "white")
        image.paste(upper, (0, 0))
        image.paste(lower, (0, upper.height + sheet.GAP))
        return image
    return sheet.sheet(panes, labels, len(panes))
