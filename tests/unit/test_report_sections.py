"""Sections of a report for campaigns that lack something, or are not the thesis's."""

from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from bladeroot.figures.curves import records
from bladeroot.figures.stick import over_load
from bladeroot.figures.still import still
from bladeroot.figures.style import panels, plain_log_scale, svg
from bladeroot.pooling.stick_table import stick_from_table
from bladeroot.report.bad_records import bad_lines
from bladeroot.report.integrity import integrity_section
from bladeroot.report.measurement import scatter_parts, stick_section
from bladeroot.report.nonlinear import nonlinear_section
from bladeroot.report.page import Box, Table
from bladeroot.stiffness.interpolation import ForceGauge, fe_forces

GAUGE = ForceGauge(0.1, 1e3, "full-scale")
FACTS = {"entry": "records", "excluded": (), "description": {"force": {
    "gauge": "pressure", "piston_area_cm2": 17.9, "full_scale_bar": 700, "accuracy_percent": 1,
    "accuracy_of": "full-scale"}}}  # fmt: skip


def sticks(*forces):
    rows = [("1B", f, 500.123 + 1e-3 * f, 0.0012, 0.004, 1e-5) for f in forces]
    columns = ["mode", "force_N", "frequency_Hz", "frequency_std_Hz", "loss_factor",
               "loss_factor_std"]  # fmt: skip
    return stick_from_table(pd.DataFrame([map(str, row) for row in rows], columns=columns))


def tables(section):
    return [part for part in section.parts if isinstance(part, Table)]


def test_errors_of_clean_records_are_no_zeros():
    stick = sticks(10e3, 16e3)
    found = tables(stick_section(stick, [], None, fe_forces(stick, np.array([12e3]), GAUGE)))
    assert "510.1230 ± 0.0012" in found[0].rows[0]
    assert "0.4000 ± 0.0010" in found[0].rows[0]


def test_no_stick_frequency_leaves_no_caption():
    stick = sticks(10e3)
    nothing = stick.isel(level=slice(0))
    section = stick_section(nothing, [], None, fe_forces(stick, np.array([12e3]), GAUGE))
    assert tables(section) == []


def rejections(count):
    verdicts = ["plateau", *["rejected: hum; taken off"] * count]
    names = [f"r{k}" for k in range(count + 1)]
    return xr.Dataset({"verdict": ("record", verdicts)}, {"record": names}, {"campaign": "lab"})


def judged(*unlike):
    """Findings of a campaign in which these records are unlike their repeats."""
    texts = {"id": "unlike-repeats", "consequence": "warn", "text": "lies -2.34 % from the others"}
    columns = {"record": unlike} | {name: [text] * len(unlike) for name, text in texts.items()}
    made = {f"finding_{name}": ("finding", np.array(v, str)) for name, v in columns.items()}
    made |= {f"finding_{side}_s": ("finding", [np.nan] * len(unlike)) for side in ("from", "to")}
    return xr.Dataset({**made, "pff_agrees": ("record", [-1])}, {"record": ["r1"]})


def test_what_is_not_repeated_has_no_scatter():
    known = dict.fromkeys(("between_record_std", "between_hold_std", "mode_direction_difference",
                           "mode_direction_difference_std"), 0.1)  # fmt: skip
    for freedom, parts in ((0, 0), (3, 1)):
        stick = xr.Dataset(
            {name: ("level", [value]) for name, value in known.items()}
            | {"record_freedom": ("level", [freedom]), "hold_freedom": ("level", [0])},
            {"mode": ("level", ["m1"])},
            {"load_name": "", "load_unit": ""},
        )
        assert len(scatter_parts(stick)) == parts


def test_each_bad_record_is_a_line_up_to_ten():
    assert bad_lines(rejections(0), judged()) == []
    one, other, more = bad_lines(rejections(1), judged("r7"))
    assert one == "rejected: r1 of lab: hum; taken off"
    assert other == "look at: r7 of lab: lies -2.34 % from the others"
    assert "docs/findings.md" in more
    many = bad_lines(rejections(13), judged())
    assert len(many) == 12
    assert many[10] == "rejected: 3 more of lab"


def test_a_record_unlike_its_repeats_is_not_overlooked():
    (box,) = (part for part in integrity_section(judged("r7")).parts if isinstance(part, Box))
    assert box.lines == ["r7 lies -2.34 % from the others."]
    assert tables(integrity_section(judged("r7")))[1].rows[0][3] == "whole"
    assert not any(isinstance(part, Box) for part in integrity_section(judged()).parts)


def test_the_stick_figure_without_forces_of_a_simulation():
    chart = over_load(sticks(10e3, 16e3), None, False)
    assert {trace.name for trace in chart.traces} == {"mode 1B"}
    assert "simulation" not in chart.caption
    section = stick_section(sticks(10e3, 16e3), [], None, None)
    assert not any("simulation" in str(part) for part in section.parts)


@pytest.mark.parametrize(("difference", "calm"), [(1e-7, True), (1e-3, False)])
def test_loss_factors_that_hardly_differ_have_short_ticks(difference, calm):
    values = {"loss_factor": [0.004, 0.004 + difference], "loss_factor_std": [1e-8, 1e-8]}
    stick = sticks(10e3, 16e3).assign({name: ("level", of) for name, of in values.items()})
    frequency, loss = over_load(stick, None, False).panels
    assert frequency.y_range is None
    assert loss.y_range == (pytest.approx((0.398, 0.402), abs=1e-4) if calm else None)


def test_a_decay_that_grows_for_a_while_is_drawn():
    values = np.linspace(-0.01, 0.01, 40)
    one = xr.Dataset(
        {
            "amplitude": ("point", np.geomspace(1e-6, 1e-4, 40)),
            "frequency": ("point", np.full(40, 500.0)),
            "frequency_std": ("point", np.full(40, 0.01)),
            "loss_factor": ("point", values),
            "loss_factor_std": ("point", np.abs(values) / 10),
        },
        attrs={"mode": "1B", "force_N": 8e3, "hold": "h1", "record": "r1"},
    )
    svg(still(records([one])))


@pytest.mark.parametrize("of_the_thesis", [True, False])
def test_the_thesis_is_compared_only_with_its_own_campaigns(of_the_thesis):
    slip = xr.Dataset(
        {
            "first_slip": ("exponent", [1e-4, 5e-5]),
            "onset": ("exponent", [1e-4, 5e-5]),
            "partial_onset": (("share", "loose"), [[2e-6]]),
        },
        {"exponent": [0.0, 0.5], "share": [0.3], "loose": [0.1]},
        {"seen_m": 2e-6, "friction": 0.4, "mode": "1B", "force_N": 4e3, "structure": "s",
         "kn": 1e9, "kt": 1e9, "reason": ""},
    )  # fmt: skip
    slip["highest"] = 4e-4
    words = nonlinear_section([], [slip], [], of_the_thesis).parts[0]
    assert ("The thesis sees the frequency fall from 2.0 µm on" in words) == of_the_thesis
    assert "source" not in words


@pytest.mark.parametrize("ratio", [1.03, 1.5, 4.0, 9.0, 40.0, 300.0, 1e4, 1e9])
@pytest.mark.parametrize("name", ["x", "y"])
@pytest.mark.parametrize("low", [0.13, 2.7])
def test_numbers_of_a_logarithmic_axis_do_not_overlap(ratio, name, low):
    drawn, ((axis,),) = panels(1, 1, 4.6, 2.8)
    values = [low, ratio * low]
    axis.plot(values, values)
    plain_log_scale(axis, name)
    drawn.draw_without_rendering()
    line = getattr(axis, f"{name}axis")
    inside = [
        label.get_window_extent()
        for label, place in zip(line.get_ticklabels(), line.get_majorticklocs(), strict=True)
        if np.prod(np.subtract(place, line.get_view_interval())) <= 0.0
    ]
    assert len(inside) >= 2
    along = sorted((getattr(box, f"{name}0"), getattr(box, f"{name}1")) for box in inside)
    assert all(end < start for (_, end), (start, _) in pairwise(along))
