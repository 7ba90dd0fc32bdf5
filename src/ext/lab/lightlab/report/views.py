"""The inspection views of the samplers: which of their pictures the page shows, under which names. Standard library only."""
import re

import lab_results as lab

MOST_ALIKE = 4  # of the layers whose names differ only in a number (one per light), this many are shown
# Layers every sampler has -> what the page calls them. They come first, so that rows compare; then the sampler's own.
TITLES = {"entropy": "entropy of the probabilities, bits",
          "brightest_probability": "probability of the strongest light", "log10_excess": "excess second moment, log10",
          "brightest": "strongest light", "path.vertices": "vertices of a path"}
GUIDE_TITLES = {"guide.continuationProbability": "continuation probability", "guide.guidingProbability": "share of guided bounces",
                "guide.sourceRadiance": "learned radiance, log10"}


def title_of(layer):
    name = layer["name"]
    if title := TITLES.get(name) or GUIDE_TITLES.get(name):
        return title
    if name.startswith("visibility."):
        return f"measured visibility, {layer.get('light') or 'light ' + name.partition('.')[2]}"
    if name.startswith("sampler.factor_"):
        return f"visibility factor of light group {name.rpartition('_')[2]}"
    return re.sub(r"^sampler\.", "", name).replace("_", " ")


def stem_of(name):
    return re.sub(r"[._]\d+$", "", name)


def chosen(layers):
    """The layers to show. Of those whose names differ only in a number, the ones with the largest means."""
    alike = {}
    for layer in layers:
        alike.setdefault(stem_of(layer["name"]), []).append(layer)
    shown = []
    for group in alike.values():
        best = sorted(group, key=lambda v: -(lab.number(v.get("mean")) or 0))[:MOST_ALIKE]
        shown += [v for v in group if len(group) <= MOST_ALIKE or any(v is b for b in best)]
    return shown


def views_of(entry, embed):
    """[{name, title, meaning, file, min, max}] of a "views" entry of results.json; min is None where colours have
    no order. embed(file): the file's key among the page's pictures, None if it is missing."""
    views = []
    layers = [v for v in (entry or {}).get("layers") or [] if v.get("name")]
    for layer in sorted(chosen(layers), key=lambda v: v["name"] not in TITLES):
        file = None if layer.get("isFlat") else embed(layer.get("file"))
        if not file:
            continue
        colours = layer.get("colours") if isinstance(layer.get("colours"), dict) else {}
        views.append({"name": layer["name"], "title": title_of(layer), "meaning": layer.get("meaning") or "",
                      "file": file, "min": lab.number(colours.get("darkest")),
                      "max": lab.number(colours.get("brightest"))})
    return views


def flat_sentences(entry):
    """Sentences about the layers that are the same everywhere; their pictures would be blank."""
    layers = [v for v in (entry or {}).get("layers") or [] if v.get("name") and v.get("isFlat")]
    sentences = []
    if any(v["name"] == "sampler.leaf" for v in layers):
        sentences.append("One leaf covers everything visible.")
    sentences += [f"One light contributes most everywhere: {v['light']}." for v in layers
                  if v["name"] == "brightest" and v.get("light")]
    same = [f"{title_of(v)} {lab.figures(lab.number(v.get('min')))}" for v in layers
            if v["name"] not in ("sampler.leaf", "brightest") and lab.number(v.get("min")) is not None]
    unknown = [title_of(v) for v in layers if lab.number(v.get("min")) is None]
    if same:
        sentences.append(f"The same everywhere: {'; '.join(same)}.")
    if unknown:
        sentences.append(f"No value anywhere: {'; '.join(unknown)}.")
    return " ".join(sentences)


def stride_sentence(results):
    """A sentence with the number of pixels that share a ray; empty if every pixel has its own."""
    coarsest = max((s.entry.get("views") or {}).get("everyNthPixel") or 1 for s in results.samplers)
    if coarsest <= 1:
        return ""
    return f" One ray stands for {coarsest} × {coarsest} pixels, because there are many lights."
