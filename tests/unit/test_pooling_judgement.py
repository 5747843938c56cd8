"""The findings of a campaign in one table, with the second opinion of every record."""

import numpy as np
import pytest
import xarray as xr
from bladeroot.pooling.judgement import SECOND_OPINION, judgement


def record(name, findings=(), usable=(1, 1, 1, 1)):
    columns = {
        "id": [f for f, _ in findings], "statistic": [2.0] * len(findings),
        "threshold": [1.0] * len(findings), "consequence": [c for _, c in findings],
        "text": [f"{f} seen" for f, _ in findings], "from_s": [0.0] * len(findings),
        "to_s": [0.5] * len(findings),
    }  # fmt: skip
    texts = ("id", "consequence", "text")
    made = {
        f"finding_{key}": ("finding", np.array(values, dtype=str if key in texts else float))
        for key, values in columns.items()
    }
    made["usable"] = ("time", np.array(usable, np.int8))
    attrs = {"record": name, "mode": "1B", "force_N": 4e3, "simulated": 1}
    return xr.Dataset(made, attrs=attrs)


def decay(difference, agrees, verdict="usable"):
    values = {name: difference for name in SECOND_OPINION[:4]}
    values |= {"pff_agrees": np.int8(agrees), "pff_finding": "" if agrees else "they differ"}
    made = {"frequency": ("point", np.zeros(0))} | {k: ((), v) for k, v in values.items()}
    return xr.Dataset(made, attrs={"verdict": verdict})


def plateau(frequency=500.0, hold="h"):
    made = {"stick_frequency": ((), frequency), "verdict": ((), "plateau")}
    return xr.Dataset(made, attrs={"mode": "1B", "force_N": 4e3, "hold": hold})


def test_findings_keep_their_record_and_nothing_is_lost():
    records = [
        record("a", [("clipping", "mask"), ("mains-hum", "subtract")], (0, 1, 1, 1)),
        record("b"),
        record("c", [("wrong-mode", "drop")]),
    ]
    decays = [decay(1e-6, 1), decay(2e-3, 0), decay(np.nan, -1, "rejected")]
    found = judgement(records, decays, [plateau()] * 3)
    assert list(found["finding_record"].values) == ["a", "a", "c"]
    assert list(found["finding_id"].values) == ["clipping", "mains-hum", "wrong-mode"]
    assert list(found["verdict"].values) == ["usable", "usable", "rejected"]
    assert found["masked"].values == pytest.approx([0.25, 0.0, 0.0])
    assert list(found["pff_agrees"].values) == [1, 0, -1]
    assert found["pff_finding"].sel(record="b").item() == "they differ"


def test_a_campaign_without_findings_survives_netcdf(tmp_path):
    found = judgement([record("a")], [decay(0.0, 1)], [plateau()])
    assert found.sizes["finding"] == 0
    found.to_netcdf(tmp_path / "integrity.nc")
    with xr.open_dataset(tmp_path / "integrity.nc") as again:
        assert again.sizes["record"] == 1


def test_a_record_unlike_its_repeats_warns_after_its_own_findings():
    records = [record("a", [("mains-hum", "subtract")]), *(record(name) for name in "bcd")]
    plateaus = [plateau(500.01), plateau(500.0), plateau(500.02), plateau(488.3)]
    found = judgement(records, [decay(0.0, 1)] * 4, plateaus)
    assert list(found["finding_record"].values) == ["a", "d"]
    assert list(found["finding_consequence"].values) == ["subtract", "warn"]
    text = found["finding_text"].values[1]
    assert text.startswith("lies -2.34 % from the other records of mode 1B at 4 kN (in clamping h)")
    assert "column exclude of records.csv" in text
    assert list(found["verdict"].values) == ["usable"] * 4


def test_a_sensor_that_sees_another_motion_than_the_others_of_its_event_warns():
    time = np.linspace(0.0, 1.0, 9)
    records, decays = [], []
    for name, frequency in (("a", 500.0), ("b", 500.0), ("c", 510.0)):
        facts = {"event": "e", "sensor": f"at {name}", "start_s": 0.1, "sampling_Hz": 5e3}
        records.append(record(name).assign_attrs(facts))
        rows = {"amplitude": np.exp(-time), "time": time, "frequency": np.full(9, frequency),
                "loss_factor": np.full(9, 0.01), "frequency_std": np.full(9, 0.1),
                "loss_factor_std": np.full(9, 1e-3)}  # fmt: skip
        curve = decay(0.0, 1).drop_vars("frequency")
        decays.append(curve.assign({key: ("point", row) for key, row in rows.items()}))
    found = judgement(records, decays, [plateau()] * 3)
    assert list(found["finding_record"].values) == ["c"]
    assert found["finding_consequence"].values[0] == "warn"
    assert "510 Hz in the median) than at sensor at a (500 Hz)" in found["finding_text"].values[0]


def test_a_step_that_sensors_of_an_event_share_warns_in_words():
    records = [record(name) for name in "ab"]
    for one, at_s in zip(records, (1.25, 1.257), strict=True):
        facts = {"event": "e", "start_s": 0.1, "sampling_Hz": 5e3, "verdict": "usable"}
        one.attrs |= facts | {"expected_Hz": 250.0, "step_s": at_s, "step_ratio": 0.9}
    found = judgement(records, [decay(0.0, 1)] * 2, [plateau()] * 2)
    assert list(found["finding_id"].values) == ["shared-step"] * 2
    assert list(found["finding_record"].values) == ["a", "b"]
    assert "2 sensors see mode 1B step at 1.25 s of the record" in found["finding_text"].values[0]
    assert found["finding_from_s"].values[0] == pytest.approx(1.15)  # of the decay


def test_a_curve_that_goes_on_where_others_of_its_event_are_disturbed_warns_in_words():
    time, records, decays = np.linspace(0.0, 2.0, 9), [], []
    for name, last_s in (("a", 1.0), ("b", 1.004), ("c", 2.1)):
        facts = {"event": "e", "sensor": f"at {name}", "start_s": 0.1, "sampling_Hz": 5e3}
        facts |= {"verdict": "usable", "expected_Hz": 250.0, "end_s": last_s}
        facts |= {"end_reason": "disturbed" if last_s < 2.0 else "the noise"}
        records.append(record(name).assign_attrs(facts))
        rows = dict.fromkeys(("amplitude", "frequency_std", "loss_factor_std"), np.full(9, 0.1))
        rows |= {"time": time * (last_s - 0.1) / 2.0, "loss_factor": np.full(9, 0.01)}
        curve = decay(0.0, 1).drop_vars("frequency")
        rows |= {"frequency": np.full(9, 500.0)}
        decays.append(curve.assign({key: ("point", row) for key, row in rows.items()}))
    found = judgement(records, decays, [plateau()] * 3)
    assert list(found["finding_id"].values) == ["shared-end"]
    assert list(found["finding_record"].values) == ["c"]
    assert "2 other sensors see mode 1B disturbed at 1 s" in found["finding_text"].values[0]
    assert found["finding_from_s"].values[0] == pytest.approx(0.9)
