"""What other programs read of a campaign is what its artifacts hold."""

import bladeroot as br
import numpy as np
import pandas as pd
import pytest
import pyuff
import xarray as xr
from bladeroot import artifacts
from scipy.io import loadmat

AMPLITUDE = np.geomspace(1e-4, 1e-6, 7)


def decay(record, mode, force, offset):
    point = {
        "time": ("s", np.arange(7.0)),
        "amplitude": ("m", AMPLITUDE),
        "frequency": ("Hz", 500.0 + offset - 1e4 * AMPLITUDE),
        "frequency_std": ("Hz", np.full(7, 0.01)),
        "loss_factor": ("1", 0.002 + AMPLITUDE),
        "loss_factor_std": ("1", np.full(7, 1e-5)),
    }
    data = {name: ("point", values, {"units": unit}) for name, (unit, values) in point.items()}
    facts = {"record": record, "mode": mode, "force_N": force, "verdict": "usable"}
    return xr.Dataset(data, attrs=facts | {"findings": "overruled: keep", "group": ""})


MEANS = xr.Dataset(
    {
        "frequency": (("level", "amplitude"), [[500.0, 501.0], [1400.0, np.nan]], {"units": "Hz"}),
        "records": (("level", "amplitude"), [[2, 1], [1, 0]], {"units": "1"}),
        "frequency_per_decade": ("level", [-3.0, np.nan], {"units": "Hz"}),
    },
    {
        "mode": ("level", ["1B", "2B"]),
        "force": ("level", [1e3, 2e3]),
        "group": ("level", ["", ""]),
        "sensor": ("level", ["tip", "tip"]),
        "amplitude": ("amplitude", [1e-6, 1e-5], {"units": "m"}),
    },
)


@pytest.fixture
def results(tmp_path):
    folder = tmp_path / "results" / "made"
    for one in (decay("a", "1B", 1e3, 0.0), decay("b", "2B", 2e3, 900.0)):
        artifacts.save(one, folder / "decay" / f"{one.attrs['record']}.nc")
    stick = xr.Dataset(
        {
            "stick_frequency": ("record", [500.0, np.nan], {"units": "Hz"}),
            "verdict": ("record", ["plateau", "rejected"], {"units": ""}),
        },
        {"record": ["a", "b"]},
    )
    artifacts.save(stick, folder / "stick.nc")
    artifacts.save(MEANS, folder / "curves.nc")
    verdict = {"answer": "named", "causes": [{"mechanism": "joint-slip", "plausible": True}]}
    artifacts.save_json(verdict, folder / "diagnosis" / "verdict.json")
    return folder


def test_the_tables_hold_every_point_and_field(results, tmp_path):
    written = br.export(results, tmp_path / "out")
    assert {path.name for path in written} == {
        "records.csv", "curves.csv", "curves_mean.csv", "curves_levels.csv", "stick.csv",
        "verdict.csv", "results.mat", "curves.uff",
    }  # fmt: skip
    curves = pd.read_csv(tmp_path / "out" / "curves.csv")
    assert len(curves) == 14
    second = curves[curves["record"] == "b"]
    np.testing.assert_allclose(second["frequency_Hz"], 1400.0 - 1e4 * AMPLITUDE)
    np.testing.assert_allclose(second["damping_ratio"], 0.5 * (0.002 + AMPLITUDE))
    told = pd.read_csv(tmp_path / "out" / "verdict.csv").set_index("entry")["value"]
    assert told["causes.0.mechanism"] == "joint-slip"
    stick = pd.read_csv(tmp_path / "out" / "stick.csv")
    assert list(stick["verdict"]) == ["plateau", "rejected"]
    known = pd.read_csv(tmp_path / "out" / "records.csv")
    assert list(known["findings"]) == ["overruled: keep"] * 2
    assert "group" not in known  # which none has
    means = pd.read_csv(tmp_path / "out" / "curves_mean.csv")
    assert list(means.columns) == ["mode", "force_N", "sensor", "amplitude_m", "frequency_Hz",
                                   "records"]  # fmt: skip
    assert list(means["frequency_Hz"]) == [500.0, 501.0, 1400.0]
    levels = pd.read_csv(tmp_path / "out" / "curves_levels.csv")
    assert levels["frequency_per_decade_Hz"][0] == -3.0


def test_matlab_and_universal_file_hold_the_same_numbers(results, tmp_path):
    br.export(results, tmp_path)
    curves = pd.read_csv(tmp_path / "curves.csv")
    matlab = loadmat(tmp_path / "results.mat", simplify_cells=True)["curves"]
    np.testing.assert_allclose(matlab["amplitude_m"], curves["amplitude_m"])
    assert list(matlab["record"]) == list(curves["record"])
    universal = pyuff.UFF(str(tmp_path / "curves.uff"))
    assert len(universal.get_set_types()) == 8
    first = universal.read_sets(0)
    assert first["id1"].startswith("a 1B: frequency")
    np.testing.assert_allclose(first["x"], AMPLITUDE[::-1], rtol=1e-5)
    np.testing.assert_allclose(first["data"], 500.0 - 1e4 * AMPLITUDE[::-1], rtol=1e-9)


@pytest.mark.parametrize(
    ("name", "unit", "column", "field"),
    [
        ("temperature", "°C", "temperature_°C", "temperature_C"),
        ("humidity", "%", "humidity_%", "humidity_percent"),
        ("bolt torque", "N m", "bolt_torque_N_m", "bolt_torque_N_m"),
        ("axial force", "kN·m", "force_kN·m", "force_kN_m"),
    ],
)
def test_a_load_of_any_name_and_unit_is_written(tmp_path, name, unit, column, field):
    one = decay("a", "1B", 0.0, 0.0).assign_attrs(load=20.0, load_name=name, load_unit=unit)
    artifacts.save(one, tmp_path / "made" / "decay" / "a.nc")
    stick = xr.Dataset(
        {"record_force": ("record", [20.0], {"units": unit})}, {"record": ["a"]},
        {"load_name": name, "load_unit": unit},
    )  # fmt: skip
    artifacts.save(stick, tmp_path / "made" / "stick.nc")
    br.export(tmp_path / "made", tmp_path)
    assert (pd.read_csv(tmp_path / "curves.csv")[column] == 20.0).all()
    assert (pd.read_csv(tmp_path / "stick.csv")[f"record_{column}"] == 20.0).all()
    made = loadmat(tmp_path / "results.mat", simplify_cells=True)
    assert (made["curves"][field] == 20.0).all()
    assert column in made["columns"]["curves"]
    assert pyuff.UFF(str(tmp_path / "curves.uff")).read_sets(0)["id2"].endswith(" 20")


def test_records_without_a_load_or_a_point_are_written(tmp_path):
    one = decay("a", "1B", 0.0, 0.0).isel(point=slice(0)).assign_attrs(load_name="", load_unit="")
    artifacts.save(one, tmp_path / "made" / "decay" / "a.nc")
    written = br.export(tmp_path / "made", tmp_path)
    assert "curves.uff" not in [path.name for path in written]
    assert list(pd.read_csv(tmp_path / "records.csv").columns) == ["record", "mode", "verdict",
                                                                   "findings"]  # fmt: skip
    assert "force" not in "".join(pd.read_csv(tmp_path / "curves.csv").columns)


def test_a_folder_without_results_is_told(tmp_path):
    with pytest.raises(ValueError, match="expected stick"):
        br.export(tmp_path, tmp_path / "out")
