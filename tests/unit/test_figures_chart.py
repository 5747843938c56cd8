"""A chart's two faces, the live one and the still one, hold what its traces hold."""

import json
from itertools import pairwise

import numpy as np
import pytest
from bladeroot.figures.chart import NOTHING, Chart, Panel, Trace, options, runs, thinned
from bladeroot.figures.live import live
from bladeroot.figures.still import still
from hypothesis import given
from hypothesis import strategies as st

X = np.geomspace(0.1, 10.0, 6)


def chart(**changes):
    one = Trace(0, X, 2.0 * X, "r1", "#ff0000", "-", error=0.1 * X, switches={"load": "4 kN"})
    band = Trace(0, X, low=X, high=np.where(X > 1.0, np.nan, 3.0 * X), switches={"load": "8 kN"})
    dots = Trace(1, X, X, "r2", "#0000ff", marker="s", error=0.1 * X, kind="measured")
    given = {"panels": [Panel("a", "x / m", "y / Hz", x_log=True, y_range=(0.1, 20.0)),
                        Panel("b", "", "z", x_ticks=["one", "two"])],
             "traces": [one, band, dots], "colours": "load"}  # fmt: skip
    return Chart("caption", **{**given, **changes})


def test_the_live_figure_has_every_number_and_every_switch():
    read = json.loads(live(chart()))
    line, band, dots = read["data"]
    np.testing.assert_allclose(line["y"], 2.0 * X, rtol=1e-6)
    np.testing.assert_allclose(line["customdata"], 0.1 * X, rtol=1e-2)
    assert ("error_y" in line, "error_y" in dots) == (False, True)
    known = int((X <= 1.0).sum())
    assert len(band["x"]) == 2 * known
    assert (dots["xaxis"], dots["marker"]["symbol"]) == ("x2", "square")
    assert read["layout"]["xaxis"]["type"] == "log"
    assert read["layout"]["xaxis2"]["ticktext"] == ["one", "two"]
    assert read["switches"] == [
        {"name": "load", "options": [["4 kN", "\u2014", "#ff0000"], ["8 kN", "\u25cf", "#1b3a5c"]]}
    ]


def test_what_is_not_known_is_null():
    gap = chart(traces=[Trace(0, X, np.where(X > 1.0, np.nan, X), line="-")])
    trace, _ = json.loads(live(gap))["data"]
    assert [value is None for value in trace["y"]] == (X > 1.0).tolist()


def test_the_still_figure_draws_the_same():
    drawn = still(chart())
    first, second = drawn.axes
    np.testing.assert_allclose(first.lines[0].get_ydata(), 2.0 * X)
    assert first.get_xscale() == "log"
    assert first.get_ylim() == (0.1, 20.0)
    assert [text.get_text() for text in second.get_xticklabels()] == ["one", "two"]
    (legend,) = drawn.legends
    assert [text.get_text() for text in legend.get_texts()] == ["measured", "4 kN", "8 kN"]


@pytest.mark.parametrize("nothing", [[], [Trace(1, X, np.full(6, np.nan), line="-")]])
def test_a_panel_without_a_point_keeps_its_place_and_says_so(nothing):
    bare = chart(traces=[Trace(0, X, X), *nothing])
    read = json.loads(live(bare))
    assert {trace["yaxis"] for trace in read["data"]} == {"y", "y2"}
    (said,) = (one for one in read["layout"]["annotations"] if one["text"] == NOTHING)
    assert (said["xref"], said["yref"]) == ("x2 domain", "y2 domain")
    assert not read["layout"]["yaxis2"]["showticklabels"]
    first, second = still(bare).axes
    assert [text.get_text() for text in second.texts] == [NOTHING]
    assert (list(second.get_yticks()), list(first.texts)) == ([], [])


def test_a_colour_that_is_a_value_has_its_scale():
    maps = chart(traces=[Trace(0, X, X, values=np.linspace(-9, 9, 6))], scale=("std", 6.0))
    read = json.loads(live(maps))
    assert (read["layout"]["coloraxis"]["cmin"], read["layout"]["coloraxis"]["cmax"]) == (-6, 6)
    assert read["data"][0]["marker"]["coloraxis"] == "coloraxis"
    assert len(still(maps).axes) == 3


def test_a_switch_of_one_option_is_none():
    assert options(chart(traces=[Trace(0, X, X, switches={"load": "4 kN"})])) == {}


@given(st.lists(st.booleans(), max_size=30))
def test_runs_are_the_known_stretches(known):
    seen = np.zeros(len(known), bool)
    stretches = runs(np.array(known, bool))
    for run in stretches:
        seen[run] = True
    assert seen.tolist() == known
    assert all(a.stop < b.start for a, b in pairwise(stretches))


@pytest.mark.parametrize("count", [1, 7, 100, 101, 5000])
def test_thinned_curves_keep_their_ends(count):
    kept = thinned(count)
    assert (kept[0], kept[-1], len(set(kept.tolist()))) == (0, count - 1, min(count, 100))
