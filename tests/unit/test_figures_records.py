"""Figures of the records draw what was measured and nothing else."""

import numpy as np
import xarray as xr
from bladeroot.figures import amplitude_force
from bladeroot.figures import decay as decay_figures
from bladeroot.figures import records as record_figures
from bladeroot.figures.stick import over_force

QUANTITIES = ("frequency", "frequency_std", "loss_factor", "loss_factor_std")


def curves(forces=(4000.0, 8000.0)):
    """Mean curves that soften by one percent of the logarithm, known at every amplitude."""
    amplitude = np.geomspace(1e-8, 1e-5, 61)
    frequency = 480.0 + 1e-3 * np.array(forces)[:, None] - 0.5 * np.log(amplitude / 1e-8)
    values = {"frequency": frequency, "loss_factor": 1e-5 * frequency}
    values |= {f"{name}_change_std": 1e-4 * value for name, value in values.items()}
    values |= {f"{name}_scatter": 1e-3 * values[name] for name in ("frequency", "loss_factor")}
    made = {name: (("level", "amplitude"), value) for name, value in values.items()}
    made["records"] = (("level", "amplitude"), np.full(frequency.shape, 4))
    made |= {"mode": ("level", ["1B"] * len(forces)), "force": ("level", list(forces))}
    return xr.Dataset(made, coords={"amplitude": amplitude}, attrs={"simulated": 0})


def test_what_is_too_uncertain_to_be_drawn_is_a_gap_in_the_waterfall():
    made = curves()
    made["frequency_change_std"][1, 20:40] = 100.0
    axis = amplitude_force.waterfall(made).axes[0]
    broken = [line for line in axis.lines if np.isnan(line.get_ydata()).any()]
    assert len(broken) == 3  # the base line, the thin line and the thick one
    for line in broken:
        assert (np.isnan(line.get_ydata()) == (np.arange(61) // 20 == 1)).all()


def test_the_forces_that_were_measured_are_the_ticks_and_no_curve_reaches_the_next_base_line():
    axis = amplitude_force.waterfall(curves((1790.0, 8000.0, 24000.0))).axes[0]
    assert [text.get_text() for text in axis.get_yticklabels()] == ["1.79", "8", "24"]
    highest = [line.get_ydata().max() for line in axis.lines[:9]]
    rises = np.subtract(highest[1::3], highest[::3])  # curve over base line, force by force
    assert ((rises > 0.5) & (rises < 1.0)).all()


def test_the_map_shows_a_force_whose_records_lie_far_apart_but_change_alike():
    made = curves()
    made["frequency_std"] = 0.01 * made["frequency"]
    shown = amplitude_force.maps(made).axes[0].collections[0].get_array()
    assert np.isfinite(np.ma.filled(shown, np.nan)).all()


def test_there_is_no_map_over_one_force():
    assert not amplitude_force.maps(curves([8000.0])).axes


def decay(record, hold="only", force=8000.0):
    """One record's curves."""
    values = {"amplitude": np.geomspace(1e-5, 1e-7, 20)}
    for name, value in (("frequency", 500.0), ("loss_factor", 1e-3)):
        values |= {name: np.full(20, value), f"{name}_std": np.full(20, 1e-5 * value)}
    attrs = {"record": record, "hold": hold, "mode": "1B", "force_N": force}
    return xr.Dataset({name: ("point", value) for name, value in values.items()}, attrs=attrs)


def legend(drawn):
    """What the legend of the first panel says, and None where it has none."""
    found = drawn.axes[0].get_legend()
    return found and [text.get_text() for text in found.get_texts()]


def test_backbones_are_told_apart_by_force_else_by_hold_else_by_record():
    by_force = decay_figures.backbones([decay("a"), decay("b", force=9000.0)])
    assert legend(by_force) is None
    assert len(by_force.axes) == 3  # two panels and the colour bar
    holds = [decay("a", "first"), decay("b", "second"), decay("c", "second")]
    by_hold = decay_figures.backbones(holds)
    assert legend(by_hold) == ["first", "second"]
    by_record = decay_figures.backbones([decay("a"), decay("b")])
    assert legend(by_record) == ["a", "b"]
    assert len(by_record.axes) == 2


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
    shown, more = record_figures.worth_showing(records, decays)
    reasons = {record.attrs["record"]: record.attrs["reason"] for record in shown}
    assert reasons == {
        "low": "", "high": "", "beating too": "rejected: beats",
        "lost": "90 % masked, rejected: no mode can be followed",
        "much": "80 % masked, touched again", "half": "50 % masked, touched again",
    }  # fmt: skip
    assert more == "not shown: 2 more rejected and 1 more partly masked"
    titles = [axis.get_title("left") for axis in record_figures.cuts(shown, more).axes]
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
    axis = over_force(stick, fe_forces, False).axes[0]
    dots, squares = (
        next(line for line in axis.lines if line.get_marker() == marker) for marker in "os"
    )
    assert dots.get_zorder() > squares.get_zorder()


def test_of_too_many_backbones_an_even_part_is_drawn_and_said():
    many = [decay(f"r{k:03d}", force=1000.0 * (1 + k % 8)) for k in range(250)]
    axes = decay_figures.backbones(many).axes
    assert len(axes[0].lines) == decay_figures.MOST
    assert axes[0].get_title(loc="left") == f"mode 1B, {decay_figures.MOST} of 250 records"
    colours = [line.get_color() for line in axes[0].lines]
    counts = [colours.count(one) for one in set(colours)]
    assert len(counts) == 8
    assert max(counts) - min(counts) <= 2
