"""Names that are programs: in a page, a figure, the settings and an artifact they are text."""

import json

import numpy as np
import pytest
import xarray as xr
from answers import Tags, in_time
from bladeroot import artifacts
from bladeroot.figures.chart import Chart, Panel, Trace
from bladeroot.figures.live import live
from bladeroot.figures.style import panels, plain, svg, title_of_record
from bladeroot.provenance import canonical_json
from bladeroot.report.page import Box, Cards, Link, Picture, Section, Table, render

TEXTS = {
    "script": "<script>alert(1)</script>",
    "end of a script": "</script><script>alert(1)</script>",
    "end of a comment": "--><img src=x onerror=alert(1)>",
    "end of a title": "</title><svg onload=alert(1)>",
    "end of an attribute": "\" onmouseover='alert(1)'",
    "entity": "&lt;script&gt;alert(1)&lt;/script&gt;",
    "template": "{{ 7 * 7 }}{% for a in b %}",
    "fraction": "$\\frac{$",
    "mathematics": "$x^2$",
    "one dollar": "5 $",
    "two dollars": "5 $ and 6 $ \\badmacro",
    "escaped dollar": "\\$\\$",
    "braces": "{record}{0}{",
    "per cent": "%s %(name)s %n",
    "null": "a\u0000b",
    "right to left": "\u202egnp.exe",
    "many": "a" * 5000,
    "emoji": "\U0001f600",
    "combining": "a" + "\u0301" * 200,
    "lines": "a\nb\r\nc",
    "other lines": "a\u2028b\u2029c",
    "place of a number": "%{x} %{customdata.y}",
}


def chart(text):
    trace = Trace(0, np.ones(2), np.ones(2), text, kind=text, texts=[text] * 2,
                  switches={text: text})  # fmt: skip
    return live(Chart(text, [Panel(text, text, text, x_ticks=[text])], [trace], colours=text))


def page(text):
    table = Table(text, (text, text), [(text, Link(text, "a.html"))])
    parts = [text, table, Box(text, [text]), Cards([(text, text, [text])])]
    parts.append(Picture("<svg></svg>", text, chart(text)))
    return render(text, text, False, [Section(text, parts)], text)


@pytest.mark.parametrize("case", TEXTS)
def test_page(case):
    seen = Tags(page(TEXTS[case])).seen
    assert {tag for tag, *_ in seen} == {tag for tag, *_ in Tags(page("a")).seen}
    assert not any(name.startswith("on") for _, *names in seen for name in names)


@pytest.mark.parametrize("case", TEXTS)
def test_live_figure(case):
    """What the page's script reads is the name; what the library takes for markup holds no tag."""
    text = TEXTS[case]
    written = chart(text)
    assert written.isascii()
    assert not set("<>&") & set(written)
    read = json.loads(written)
    (trace,) = read["data"]
    assert trace["meta"] == {text: text}
    shown = [trace["name"], *trace["text"], *read["layout"]["xaxis"]["ticktext"]]
    assert not any("<" in one or "%{" in one for one in shown)
    hover = trace["hovertemplate"].replace("%{text}", "").replace("%{y:.6g}", "")
    for tag in ("<b>", "</b>", "<br>", "<extra>", "</extra>"):
        hover = hover.replace(tag, "", 1)
    assert "<" not in hover
    assert "%{" not in hover


QUICK = ("script", "fraction")


@pytest.mark.parametrize(
    "case", [pytest.param(name, marks=[pytest.mark.suite] * (name not in QUICK)) for name in TEXTS]
)
def test_figure(case):
    text = TEXTS[case]
    # what an SVG cannot hold, a name in a sheet cannot either
    text = text.replace("\0", "")
    drawn, (axes,) = panels(1, 2, 6.0, 3.0)
    for axis in axes:
        axis.plot([1.0, 1000.0], [1.0, 2.0], label=text)
        axis.legend()
        axis.text(1.0, 1.0, text)
    axes[0].set_xscale("log")
    axes[1].set_yticks([1, 2], [plain(text), "b"])
    title_of_record(axes[0], {"record": text, "mode": text, "force_N": 1.0, "reason": text})
    with in_time():
        seen = Tags(svg(drawn)).seen
    assert not {tag for tag, *_ in seen} & {"script", "img", "foreignobject"}
    assert not any(name.startswith("on") for _, *names in seen for name in names)


@pytest.mark.parametrize("case", TEXTS)
def test_settings_and_artifact(case, tmp_path):
    text = TEXTS[case]
    settings = canonical_json({"title": text})
    assert json.loads(settings) == {"title": text}
    assert not set("<>") & set(settings)
    artifacts.save_json({"campaign": text, "reason": text}, tmp_path / "verdict.json")
    assert artifacts.load_json(tmp_path / "verdict.json")["reason"] == text
    made = xr.Dataset({"x": ("n", [1.0], {"long_name": "a"})}, attrs={"campaign": "a"})
    artifacts.save(made, tmp_path / "a.nc", settings=settings)
    assert artifacts.load(tmp_path / "a.nc").attrs["settings"] == settings
