"""Figures of the records draw what was measured and nothing else."""

import numpy as np
import xarray as xr
from bladeroot.figures import curves as curve_figures
from bladeroot.figures import records as record_figures
from bladeroot.figures.stick import over_load
from report_bench import curves

QUANTITIES = ("frequency", "frequency_std", "loss_factor", "loss_factor_std")


def test_what_is_too_uncertain_to_be_drawn_is_a_gap():
    made = curves()
    made["frequency_std"][:] = 100.0  # that of the level hides nothing
    made["frequency_change_std"][1, 20:40] = 100.0
    lines = [one for one in curve_figures.means(made).traces if one.line and one.panel == 0]
    assert [int(np.isnan(one.y).sum()) for one in lines] == [0, 20]


def test_no_usable_record_has_no_figure():
    assert curve_figures.means(curves(())) is None
    assert curve_figures.records([]) is None


def decay(record, hold="only", force=8000.0):
    """One record's curves."""
    values = {"amplitude": np.geomspace(1e-5, 1e-7, 20)}
    for name, value in (("frequency", 500.0), ("loss_factor", 1e-3)):
        values |= {name: np.full(20, value), f"{name}_std": np.full(20, 1e-5 * value)}
    attrs = {"record": record, "hold": hold, "mode": "1B", "force_N": force}
    return xr.Dataset({name: ("point", value) for name, value in values.items()}, attrs=attrs)


def test_records_are_told_apart_by_load_else_by_what_differs():
    by_load = curve_figures.records([decay("a"), decay("b", force=9000.0)])
    assert by_load.colours == "axial force"
    alone = curve_figures.records([decay("a"), decay("b")])
    assert alone.colours == "record"
    for chart in (by_load, alone):
        of_record = {one.switches["record"]: one.colour for one in chart.traces}
        assert len(set(of_record.values())) == 2


def cut(name, force=8000.0, masked=0.0, findings=(), bins=50):
    """A free decay of one second with a masked end and findings (id, consequence, text)."""
    usable = np.arange(bins and 100) < 100 * (1.0 - masked)
    made = {"usable": ("time", usable.astype(np.int8))}
    made |= {f"overview_{what}": ("bin", np.linspace(0.0, 1.0, bins)) for what in ("time", "max")}
    made["overview_min"] = ("bin", -made["overview_max"][1])
    for k, what in enumerate(("id", "consequence", "text")):
        made[f"finding_{what}"] = ("finding", np.array([one[k] for one in findings], dtype=str))
    attrs = {"record": name, "mode": "1B", "force_N": force, "start_s": 0.0}
    attrs |= {"release_s": 0.0, "end_s": 1.0}
    return xr.Dataset(made, coords={"time": np.arange(usable.size) / 100}, attrs=attrs)


def test_the_worst_records_are_shown_with_their_reasons_and_the_rest_are_counted():
    beats, unread = ("beating", "drop", "beats"), ("unreadable", "drop", "not a number")
    touched = ("shaker", "mask", "touched again")
    records = [
        cut("low", 1000.0), cut("middle", 4000.0), cut("high"),
        cut("a little", 4000.0, 0.1, [touched]), cut("half", 4000.0, 0.5, [touched]),
        cut("much", 4000.0, 0.8, [touched]), cut("beating", findings=[beats]),
        cut("beating too", findings=[beats]), cut("unread", findings=[unread], bins=0),
        cut("lost", masked=0.9, findings=[touched]),
    ]  # fmt: skip
    lost = {"verdict": "rejected", "findings": "no mode can be followed"}
    decays = {
        record.attrs["record"]: xr.Dataset(
            attrs=lost if record.attrs["record"] == "lost" else {"verdict": "usable"}
        )
        for record in records
    }
    shown = record_figures.worth_showing(records, decays)
    reasons = {record.attrs["record"]: record.attrs["reason"] for record in shown}
    assert reasons == {
        "low": "", "high": "", "beating too": "rejected: beats",
        "lost": "90 % masked, rejected: no mode can be followed",
        "much": "80 % masked, touched again", "half": "50 % masked, touched again",
    }  # fmt: skip
    titles = [axis.get_title("left") for axis in record_figures.cuts(shown).axes]
    assert titles[-1].splitlines() == ["half: mode 1B, 4.00 kN", "50 % masked, touched again"]


def test_measured_frequencies_are_not_hidden_by_the_simulations_at_the_same_forces():
    force, both = [4000.0, 8000.0], np.array([[500.0, 510.0]])
    stick = xr.Dataset({name: ("level", both[0]) for name in QUANTITIES})
    stick = stick.assign(mode=("level", ["1B", "1B"]), force=("level", force))
    fe_forces = xr.Dataset(
        {name: (("mode", "force"), both) for name in QUANTITIES[::2]}
        | {name: (("force_error", "mode", "force"), both[None]) for name in QUANTITIES[1::2]},
        coords={"mode": ["1B"], "force": force, "force_error": ["reading"]},
        attrs={"primary_force_error": "reading"},
    )
    shown = [one.marker for one in over_load(stick, fe_forces, False).traces if one.panel == 0]
    assert shown == ["s", "o"]  # the later is on top


def test_of_too_many_backbones_an_even_part_is_drawn_and_said():
    many = [decay(f"r{k:03d}", force=1000.0 * (1 + k % 8)) for k in range(250)]
    chart = curve_figures.records(many)
    lines = [one for one in chart.traces if one.panel == 0]
    assert len(lines) == curve_figures.MOST_RECORDS
    assert chart.panels[0].title == f"mode 1B, {curve_figures.MOST_RECORDS} of 250 records"
    loads = [one.switches["axial force"] for one in lines]
    counts = [loads.count(one) for one in set(loads)]
    assert len(counts) == 8
    assert max(counts) - min(counts) <= 2
