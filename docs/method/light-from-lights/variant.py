"""A scene with another integrator, for the scripts of this folder."""
import re


def variant(path, integrator, parameters, folder, replace=()):
    """Writes it to a folder of its own, so that it names its files where they are. `replace`: pairs of old and new text."""
    text = path.read_text()
    found = re.search(r'"integer maxdepth" *\[? *(\d+)', text)
    depth = int(found.group(1)) if found else 5
    line = f'Integrator "{integrator}" "integer maxdepth" {depth} {parameters}'
    text, count = re.subn(r'(?m)^Integrator .*(\n[ \t]+.*)*', line, text, count=1)
    assert count == 1, path
    text = re.sub(r'"([^"\n]+\.(?:inc|pbrt|ply|png|exr|pfm|spd))"',
                  lambda m: f'"{path.parent / m.group(1)}"' if (path.parent / m.group(1)).exists() else m.group(0), text)
    for old, new in replace:
        text = text.replace(old, new)
    copy = folder / f"{path.stem}-{integrator}.pbrt"
    copy.write_text(text)
    return copy
