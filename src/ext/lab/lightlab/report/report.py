#!/usr/bin/env python3
"""python3 report.py OUT: writes OUT/report.html, one page with everything inside (pictures, charts, table), and
OUT/table.md. Reads OUT/results.json, the pictures it names and the charts of charts.py. Standard library only."""
import base64
import html
import json
import pathlib
import re
import sys
import zlib

sys.dont_write_bytecode = True
import lab_results as lab  # noqa: E402
import views  # noqa: E402
import table  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
CHARTS = [("chart-error-time", "Error against time"), ("chart-error-samples", "Error against samples"),
          ("chart-speed-accuracy", "Speed against accuracy"), ("chart-overhead", "Where the time goes")]
SCRIPTS = ("report_exposure.js", "report_viewer.js", "report_page.js")  # in this order
# Greys of chart_style.py and chart_overhead.py -> colours of the page, which follow light and dark.
PAGE_COLOURS = {"#1b1f24": "--ink", "#5b636e": "--soft", "#e3e6ea": "--grid", "#ffffff": "--paper",
                "#30363f": "--bar-a", "#8b939e": "--bar-b", "#d3d8de": "--bar-c"}


def esc(value):
    return html.escape(str(value), quote=True)


def data_uri(file):
    return "data:image/png;base64," + base64.b64encode(file.read_bytes()).decode()


def packed(file):
    """The file as base64, compressed for the page's DecompressionStream."""
    return base64.b64encode(zlib.compress(file.read_bytes(), 9)).decode()


def inline_svg(file, prefix, title):
    """The chart as an element of the page: unique ids, the page's greys, no fixed size, an accessible name."""
    text = file.read_text(encoding="utf-8")
    text = text[text.index("<svg"):]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.S)
    text = re.sub(r'\bid="([^"]+)"', rf'id="{prefix}-\1"', text)
    text = re.sub(r"url\(#([^)]+)\)", rf"url(#{prefix}-\1)", text)
    text = re.sub(r'(xlink:href|href)="#([^"]+)"', rf'\1="#{prefix}-\2"', text)
    for grey, variable in PAGE_COLOURS.items():
        text = re.sub(rf"((?:fill|stroke): ?){grey}", rf"\1var({variable})", text)
    # matplotlib's SVG has no fill on text of the default colour, and its style sheet would act on the whole page.
    text = re.sub(r"<style[^>]*>.*?</style>", "", text, flags=re.S)
    head, rest = text.split(">", 1)
    head = re.sub(r'\s(width|height)="[^"]*"', "", head)
    return f'{head} role="img" aria-label="{esc(title)}">{rest}'


def mark(s):
    return f'<span class="swatch{" hollow" if not s.mayWin else ""}" style="--c:{s.colour_css}"></span>'


def tags(s, results):
    found = []
    if s is results.named("winner"):
        found.append('<span class="tag win">lowest error</span>')
    elif s is results.named("lowestError"):
        found.append('<span class="tag">lowest mean, undecided</span>')
    if s.isOracle:
        found.append('<span class="tag">measuring instrument</span>')
    return "".join(found)


def table_html(results):
    columns = [c for c in table.COLUMNS if c.main or any(c.value(s) is not None for s in results.samplers)]
    winner = results.named("winner")
    groups, heads, rows = [], [], []
    for c in columns:
        if groups and groups[-1][0] == c.group:
            groups[-1][1] += 1
            groups[-1][2] += c.main
        else:
            groups.append([c.group, 1, int(c.main)])
    first = {}
    for c in columns:
        start = " first" if first.setdefault(c.group, c.key) == c.key and c.group else ""
        first[c.key + "/start"] = start
        kind = "text" if c.key == "label" else "number"
        sort = ' aria-sort="ascending"' if c.key == "relL2" else ' aria-sort="none"'
        heads.append(f'<th scope="col" data-key="{c.key}" data-kind="{kind}" data-main="{int(c.main)}" '
                     f'class="{kind}{start}"{sort}><button type="button" title="{esc(c.title or c.name)}">{esc(c.name)}'
                     "<span aria-hidden=\"true\" class=\"arrow\"></span></button></th>")
    for s in results.ranked():
        cells = []
        for c in columns:
            value = c.value(s)
            attribute = "" if value is None else f' data-value="{esc(value)}"'
            start, hidden = first[c.key + "/start"], f' data-main="{int(c.main)}"'
            if c.key == "label":
                cells.append(f'<th scope="row"{attribute}>{mark(s)}{esc(s.label)}{tags(s, results)}</th>')
            elif c.key == "verdict":
                why = esc((s.summary.get("bias") or {}).get("text") or "")
                cells.append(f'<td class="verdict{start}"{attribute}{hidden}>'
                             f'<span class="{esc(s.verdict)}" title="{why}">{esc(s.verdict)}</span></td>')
            else:
                best = " best" if s in table.best_of(c, results.samplers) else ""
                cells.append(f'<td class="number{start}{best}"{attribute}{hidden}>{esc(c.show(s))}</td>')
        kind = "biased" if s.biased else "oracle" if s.isOracle else "winner" if s is winner else ""
        rows.append(f'<tr data-label="{esc(s.label)}" data-index="{s.index}" class="{kind}">{"".join(cells)}</tr>')
    top = "".join(f'<th colspan="{n}" data-all="{n}" data-few="{few}" scope="colgroup">{esc(name)}</th>' if name else
                  f'<td colspan="{n}"></td>' for name, n, few in groups)
    return (f'<table id="summary"><caption>All numbers are means over {esc(results.seeds_text())}; ± is the standard '
            "error. Bold: best of the samplers that may win. Click a heading to sort.</caption>"
            f'<thead><tr class="groups">{top}</tr><tr class="heads">{"".join(heads)}</tr></thead>'
            f'<tbody>{"".join(rows)}</tbody></table>')


def pairs_html(pairs):
    return "<dl>" + "".join(f"<dt>{esc(k)}</dt><dd>{v}</dd>" for k, v in pairs if v not in ("", None)) + "</dl>"


def value_html(value):
    """Any JSON value as readable HTML."""
    if isinstance(value, dict):
        return pairs_html([(k, value_html(v)) for k, v in value.items()]) if value else "none"
    if isinstance(value, list):
        if any(isinstance(v, (dict, list)) for v in value):
            return "<ol>" + "".join(f"<li>{value_html(v)}</li>" for v in value) + "</ol>"
        return esc(", ".join(str(v) for v in value))
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return esc(f"{value:.6g}")
    return "unknown" if value is None else esc(value)


def parameters_html(parameters):
    """The parameters as a list of name=value."""
    if not isinstance(parameters, dict) or not parameters:
        return value_html(parameters) if parameters else "none"

    def text(value):
        if isinstance(value, bool):
            return str(value).lower()
        return f"{value:.6g}" if isinstance(value, float) else str(value)
    return '<ul class="parameters">' + "".join(
        f"<li><code>{esc(k)}={esc(text(v))}</code></li>" for k, v in parameters.items()) + "</ul>"


def details_html(results):
    d, machine = results.data, results.data.get("machine") or {}
    size = " × ".join(str(v) for v in d.get("resolution") or [])
    memory = lab.number(machine.get("memoryGB"))
    run = pairs_html([
        ("scene", f"<code>{esc(d.get('scene'))}</code>"), ("scene hash", f"<code>{esc(d.get('sceneHash'))}</code>"),
        ("command line", f"<code>{esc(d.get('commandLine'))}</code>"),
        ("program", esc(lab.program_text(d))), ("date", esc(d.get("date"))),
        ("budget", esc(results.budget_text())), ("seeds", esc(d.get("seeds"))),
        ("resolution", esc(size)),
        ("depth", esc(d.get("maxDepth")) + (" (direct light only)" if d.get("direct") else "") +
         (", --sampled-light" if (d.get("settings") or {}).get("sampled-light") else "")),
        ("processor", esc(machine.get("cpu"))), ("threads", esc(machine.get("threads"))),
        ("memory", f"{memory:g} GB" if memory is not None else ""), ("system", esc(machine.get("os")))])
    references = "".join(
        f"<h3>Reference {i if len(results.references) > 1 else ''}</h3>" + pairs_html([
            ("file", f"<code>{esc(r.get('file'))}</code>"), ("made with", esc(r.get("sampler") or "")),
            ("source", esc(r.get("source") or "")),
            ("samples", value_html(r.get("samples"))), ("seconds", value_html(r.get("seconds"))),
            ("its own relL2", value_html(r.get("noise")))]) for i, r in enumerate(results.references))
    samplers = []
    for s in results.samplers:
        e = s.entry
        bias = s.summary.get("bias") or {}
        check = {"verdict": s.verdict, **{n: v for n, v in bias.items() if n != "verdict" and v is not None}}
        # The parameters have a line of their own.
        report = {n: v for n, v in (e.get("report") or {}).items() if n != "parameters"}
        body = pairs_html([
            ("light sampler", f"<code>{esc(s.kind)}</code>"),
            ("parameters", parameters_html(e.get("parameters") or {})),
            ("mesh lights as one", value_html(bool(e.get("meshLights")))),
            ("judged against reference", esc(e.get("reference")) if len(results.references) > 1 else ""),
            ("bias check", value_html(check)), ("its report", value_html(report)),
            ("speed-up against", value_html(s.summary["speedUps"]) if s.summary.get("speedUps") else "")])
        structure = f"<pre>{esc(e['structure'])}</pre>" if e.get("structure") else ""
        samplers.append(f"<details><summary>{mark(s)}{esc(s.label)}</summary>{body}{structure}</details>")
    return (f'<div class="facts"><div><h3>The run</h3>{run}</div><div>{references}'
            f'<h3>Effective parameters</h3>{"".join(samplers)}</div></div>')


def pictures_of(results):
    """What the viewer can show: [{key, label, kind, ...}] and the embedded pictures by file name."""
    pictures, items = {}, []

    def embed(name):
        file = results.folder / str(name) if name else None
        if file is None or not file.is_file():
            return None
        if str(name) not in pictures:
            pictures[str(name)] = packed(file) if file.suffix == ".hdr" else data_uri(file)
        return str(name)
    for i, r in enumerate(results.references):
        label = "reference" if len(results.references) == 1 else f"reference {i} ({r.get('sampler') or 'given'})"
        items.append({"kind": "reference", "label": label, "result": embed(r.get("pictureRange")), "error": None,
                      "colour": "", "note": "", "biased": False, "reference": i,
                      "views": views.views_of(results.data.get("views"), embed) if i == 0 else [],
                      "flat": views.flat_sentences(results.data.get("views")) if i == 0 else ""})
    for s in results.samplers:
        items.append({"kind": "sampler", "label": s.label, "result": embed(s.entry.get("pictureRange")),
                      "error": embed(s.entry.get("errorPicture")), "colour": s.colour_css,
                      "note": f"relL2 {lab.figures(s.error())}" if s.error() is not None else "",
                      "biased": s.biased, "reference": s.entry.get("reference") or 0,
                      "views": views.views_of(s.entry.get("views"), embed),
                      "flat": views.flat_sentences(s.entry.get("views"))})
    return items, pictures


def scale_html(results):
    """What the colours of the error pictures mean."""
    most = lab.number(results.data.get("errorScale"))
    if most is None:
        return ""
    return (f'<p class="scale">Error {esc(lab.ERROR_MEASURE)}: 0 <span class="ramp" style="background: '
            f'linear-gradient(to right, {", ".join(lab.ERROR_RAMP)})"></span> {esc(lab.figures(most))} and more, '
            "the same scale for all.</p>")


def view_scale_html(view):
    if view["min"] is None or view["max"] is None:
        return "a colour for each"
    return (f'{esc(lab.figures(view["min"]))} <span class="ramp" style="background: linear-gradient(to right, '
            f'{", ".join(lab.ERROR_RAMP)})"></span> {esc(lab.figures(view["max"]))}')


def inside_html(results, items):
    """A row of pictures per sampler, the scene's own first. The page's script inserts the pictures, so that
    the page holds each only once."""
    rows = []
    for i, item in enumerate(items):
        if not item["views"] and not item["flat"]:
            continue
        name, figures = "the scene" if item["kind"] == "reference" else item["label"], []
        for view in item["views"]:
            about = f'{name}, {view["title"]}: show in the viewer'
            figures.append(
                f'<figure><button type="button" data-item="{i}" data-view="{esc(view["name"])}" '
                f'title="{esc(view["meaning"])}" aria-label="{esc(about)}"><img alt="" data-file="{esc(view["file"])}">'
                f'</button><figcaption>{esc(view["title"])}<small>{view_scale_html(view)}</small></figcaption>'
                '</figure>')
        swatch = f'<span class="swatch" style="--c:{item["colour"]}"></span>' if item["colour"] else ""
        rows.append(f'<div class="view" data-label="{esc(name)}"><h3>{swatch}{esc(name)}</h3>'
                    + (f'<p class="note flat">{esc(item["flat"])}</p>' if item["flat"] else "")
                    + (f'<div class="strip">{"".join(figures)}</div>' if figures else "") + '</div>')
    if not rows:
        return ""
    return ('<section id="inside" aria-labelledby="h-inside"><h2 id="h-inside">Inspection</h2>'
            '<p class="note">State of each sampler at the first visible surface that light is sampled at, '
            'after its first run. '
            'Dark grey: no such surface. Magenta: no value, for instance because no light reaches the place.'
            f'{esc(views.stride_sentence(results))} Click: show in the viewer, with the sampler\u2019s picture on the '
            f'left.</p>{"".join(rows)}</section>')


def script_json(value):
    """JSON that cannot end the script element it stands in."""
    return json.dumps(value, separators=(",", ":")).replace("<", "\\u003c").replace("\u2028", "\\u2028")


def page(results):
    for s in results.samplers:
        s.colour_css = "var(--ink)" if s.colour == lab.INK else s.colour
    d = results.data
    items, pictures = pictures_of(results)
    charts = []
    for k, (name, title) in enumerate(CHARTS):
        file = results.folder / f"{name}.svg"
        if file.is_file():
            charts.append(f'<figure class="chart" id="{name}">{inline_svg(file, f"c{k}", title)}</figure>')
    missing = '<p class="note">There are no charts: charts.py was not run or drew nothing.</p>' if not charts else ""
    first, *rest = results.sentences()
    size = d.get("resolution") or [0, 0]
    facts = [results.budget_text(), results.seeds_text(), f"{size[0]} × {size[1]} pixels",
             "direct light only" if d.get("direct") else f"depth {d.get('maxDepth')}",
             re.sub(r"^(\S+)T(\d+:\d+)(:\d+)?Z$", r"\1 \2 UTC", str(d.get("date") or "")),
             lab.program_text(d)]
    start = results.named("winner") or results.named("lowestError") or results.ranked()[0]
    others = [s for s in results.ranked() if s is not start and not s.isOracle]
    data = {"items": items, "size": size, "exposure": lab.number(d.get("exposure")),
            "crops": results.crops, "pictures": pictures,
            "left": next((i for i, v in enumerate(items) if others and v["label"] == others[-1].label), 0),
            "right": next(i for i, v in enumerate(items) if v["kind"] == "sampler" and v["label"] == start.label)}
    fill = {
        "title": f"{d.get('sceneName') or 'scene'} · lightlab",
        "scene": d.get("sceneName") or d.get("scene") or "scene",
        "facts": " · ".join(f for f in facts if f)}
    raw = {
        "verdict": f'<p class="answer">{esc(first)}</p>' + "".join(f"<p>{esc(s)}</p>" for s in rest),
        "scale": scale_html(results), "inside": inside_html(results, items),
        "insidelink": '<a href="#inside">Inspection</a>' if any(v["views"] or v["flat"] for v in items) else "",
        "charts": f'<div class="charts">{"".join(charts)}</div>{missing}', "table": table_html(results),
        "details": details_html(results), "data": script_json(data),
        "style": (HERE / "report.css").read_text(encoding="utf-8"),
        "script": "\n".join((HERE / f).read_text(encoding="utf-8") for f in SCRIPTS)}
    values = {**{k: esc(v) for k, v in fill.items()}, **raw}
    template = (HERE / "report_template.html").read_text(encoding="utf-8")
    # One pass: what was filled in is never searched again.
    return re.sub(r"@([a-z]+)@", lambda m: values[m.group(1)], template)


def write(folder):
    results = lab.Results(folder)
    (results.folder / "table.md").write_text(table.markdown(results), encoding="utf-8")
    text = page(results)
    (results.folder / "report.html").write_text(text, encoding="utf-8")
    print(f"report.html ({len(text) / 1e6:.1f} MB), table.md")


if __name__ == "__main__":
    lab.main_with(write)
