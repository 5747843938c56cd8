"""Two runs side by side: what is the same is counted, what differs is told."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from bladeroot import artifacts
from bladeroot.command.main import main
from bladeroot.pooling.stick_table import stick_from_table
from bladeroot.report.compare import Side, _over_amplitude, compared, page, text
from click.testing import CliRunner
from report_bench import SEATING, cause, verdict

MADE = {"version": "1", "date": "2030-01-01", "settings": {"decay": "blocks", "search": "a"},
        "sources": {"records.csv": "0" * 64}}  # fmt: skip


@pytest.fixture
def side():
    rows = [("1B", f, 500.0 + 1e-3 * f, 0.01, 0.004, 1e-5) for f in (10e3, 16e3)]
    columns = ["mode", "force_N", "frequency_Hz", "frequency_std_Hz", "loss_factor",
               "loss_factor_std"]  # fmt: skip
    stick = stick_from_table(pd.DataFrame([map(str, row) for row in rows], columns=columns))
    stick = stick.drop_dims("record").assign(
        verdict=("record", ["plateau", "plateau"]),
        stick_frequency=("record", [510.0, 516.0]),
        sensor=("record", ["tip", "tip"]),
    )
    stick = stick.assign_coords(record=["r1", "r2"]).assign_attrs(simulated=0, campaign="lab")
    return Side("before", MADE, stick, verdict(causes=[cause()]))


def said(a, b):
    return "\n".join(text(compared(a, b)))


def test_a_run_beside_itself_differs_in_nothing(side):
    told = said(side, replace(side, label="after"))
    assert "that both have: 2, of which 2 are the same" in told
    assert "2 records are in both; 0 only in before, 0 only in after." in told
    assert "They are read alike." in told
    assert "No settings differ." in told
    assert "No sources differ." in told


def test_what_changed_is_told_by_kind(side):
    stick = side.stick.copy(deep=True)
    stick["frequency"] = stick["frequency"] + [0.0, 0.03]
    stick["verdict"] = ("record", ["plateau", "rejected: hum"])
    stick = stick.assign_coords(record=["r1", "r2"])
    other = Side(
        "after",
        MADE | {"settings": {"decay": "thesis", "search": "a"}, "sources": {}},
        stick,
        verdict(causes=[cause((SEATING,))]),
    )
    told = said(side, other)
    assert "+58 ppm (2.1 std)" in told
    assert "of which 1 are the same" in told
    assert "rejected: hum" in told
    assert "incomplete contact" in told
    assert "not named" in told
    assert "blocks" in told
    assert "000000000000" in told
    assert "search" not in told


def test_simulated_is_said_of_the_one_that_is(side):
    made = replace(side, label="rig", stick=side.stick.assign_attrs(simulated=1))
    assert "simulated: rig" in page(side, made)
    assert "Simulated records" in page(made, replace(made, label="rig 2"))
    told = page(side, side)
    assert "Simulated records" not in told
    assert "simulated: " not in told


def test_the_command_compares_folders_of_results(side, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("old", "new"):
        folder = tmp_path / name / "lab"
        artifacts.save(side.stick.assign(one=xr.DataArray(np.ones(2), dims="level")),
                       folder / "stick.nc")  # fmt: skip
        artifacts.save_json(MADE, folder / "report" / "provenance.json")
        artifacts.save_json(dict(side.verdict), folder / "diagnosis" / "verdict.json")
    done = CliRunner().invoke(main, ["compare", "old/lab", "new/lab"])
    assert done.exit_code == 0, done.output
    assert "old/lab" in done.output
    assert (tmp_path / "results" / "lab-lab.html").is_file()
    gone = CliRunner().invoke(main, ["compare", "old/lab", "nothing"])
    assert gone.exit_code == 1
    assert "no results here" in gone.output


def test_curves_are_compared_where_no_plateau_is_reached(side):
    amplitude = np.geomspace(1e-7, 1e-4, 7)
    shape = ("level", "amplitude")
    curves = xr.Dataset(
        {
            "frequency": (shape, [100.0 - 1e4 * amplitude]),
            "frequency_std": (shape, np.full((1, 7), 1e-3)),
            "frequency_change_std": (shape, np.full((1, 7), 1e-4)),
            "loss_factor": (shape, [[np.nan, *np.full(6, 0.01)]]),
            "loss_factor_std": (shape, np.full((1, 7), 1e-4)),
            "loss_factor_change_std": (shape, np.full((1, 7), 1e-5)),
        },
        {"mode": ("level", ["m1"]), "force": ("level", [0.0]), "sensor": ("level", ["top"]),
         "amplitude": amplitude},
        {"load_name": "", "load_unit": ""},
    )  # fmt: skip
    one = replace(side, curves=curves)
    (table,) = _over_amplitude(one, replace(one, label="after"))
    assert [row[2] for row in table.rows] == ["0.316 µm", "10 µm", "100 µm"]
    assert table.rows[-1][3:] == ["99.0000 ± 0.0010"] * 2 + ["1.000 ± 0.010 %"] * 2
    assert _over_amplitude(one, side) == []
    other = replace(one, curves=curves.assign_coords(sensor=("level", ["foot"])))
    assert _over_amplitude(one, other) == []
