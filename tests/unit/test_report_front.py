"""The first page: the answer at a glance, and each stage's with the chapter that has the rest."""

import numpy as np
import pytest
import xarray as xr
from bladeroot.report.contents import _ordered
from bladeroot.report.front import front_sections
from bladeroot.report.page import Cards, Link, Table
from report_bench import cause, found, verdict

QUANTILES = (0.025, 0.16, 0.5, 0.84, 0.975)


def inference(kn, law="one power", **attrs):
    """Quantiles at two forces; kt is twice kn."""
    k = 1e9 * kn * np.array([0.5, 0.8, 1.0, 1.2, 2.0])
    both = np.stack([k, 2.0 * k])
    return xr.Dataset(
        {"k_quantile": (("force", "stiffness", "quantile"), np.stack([0.5 * both, both]))},
        {"force": [6e3, 12.1e3], "stiffness": ["kn", "kt"], "quantile": list(QUANTILES)},
        {"structure": "s", "law": law, **attrs},
    )


@pytest.fixture
def stages():
    known = {"frequency_std": 0.3, "loss_factor": 2e-3, "loss_factor_std": 1e-5,
             "onset_amplitude": 1e-6, "onset_amplitude_std": 1e-7, "records": 4}  # fmt: skip
    stick = xr.Dataset(
        {
            "frequency": ("level", [480.0, 560.0, 1300.0, 1480.0]),
            "mode": ("level", ["1B", "1B", "2B", "2B"]),
            "force": ("level", [6e3, 12e3] * 2),
            **{name: ("level", [value] * 4) for name, value in known.items()},
            "verdict": ("record", ["plateau", "rejected: hum"]),
            "record_mode": ("record", ["1B", "2B"]),
        },
        {"record": ["r1", "r2"]},
    )
    stiffness = xr.Dataset(
        {
            "status": (("structure", "force"), [["root", "root"]]),
            "correlation": (("structure", "force"), [[-0.99, -0.98]]),
            **{f"ln_{n}_std": (("structure", "force"), [[2.0, 2.0]]) for n in ("kn", "kt")},
        },
        {"structure": ["s"], "force": [6e3, 12e3]},
    )
    theory = xr.Dataset({f"{name}_theory": ("force", [1.3e9, 1.3e9]) for name in ("kn", "kt")})
    judged = xr.Dataset(
        {"finding_id": ("finding", ["hum"]), "pff_agrees": ("record", [1, -1])},
        {"record": ["r1", "r2"]},
    )
    return {"stick": stick, "stiffness": stiffness, "theory": theory, "integrity": judged}


def front(stages, joints=(), amplitudes=(), said=None, entry="records", modes=("1B", "2B")):
    facts = {"entry": entry, "description": {}, "modes": list(modes)}
    said = said or verdict(causes=[cause()])
    sections = front_sections(
        facts, stages, joints, amplitudes, [found()], [said], [], [], "report/"
    )
    parts = [part for section in sections for part in section.parts]
    (cards,) = (part.cards for part in parts if isinstance(part, Cards))
    (table,) = (part for part in parts if isinstance(part, Table))
    return cards, {str(row[0]): row for row in table.rows}, parts


def test_mode_frequency_damping_and_verdict_come_first(stages):
    one, other, last = front(stages)[0]
    lines = ["loss factor 0.20 %", "6.00 to 12.0 kN, 8 records"]
    assert one == ("mode 1B", "480.0 to 560.0 Hz", lines)
    assert other[1] == "1\u202f300.0 to 1\u202f480.0 Hz"
    assert last == (
        "verdict", "cause named", ["load dependent stiffness (97 %)", "compared with S"],
    )  # fmt: skip


def test_modes_stand_in_the_order_that_the_campaign_names_them(stages):
    modes = ["2B", "1B"]
    stick = _ordered(stages, modes)["stick"]
    assert stick["mode"].values.tolist() == ["2B", "2B", "1B", "1B"]
    assert stick["frequency"].values.tolist() == [1300.0, 1480.0, 480.0, 560.0]
    cards, rows, _ = front({**stages, "stick": stick}, modes=modes)
    assert [card[0] for card in cards[:2]] == ["mode 2B", "mode 1B"]
    told = [name for name in rows if name.startswith("stick frequency")]
    assert told == ["stick frequency, 2B", "stick frequency, 1B"]


def test_without_a_plateau_the_curves_have_frequency_and_damping(stages):
    stages["stick"] = stages["stick"].isel(level=slice(2))
    stages["curves"] = xr.Dataset(
        {
            "frequency": (("level", "amplitude"), [[1400.0, 1390.0]]),
            "frequency_std": (("level", "amplitude"), [[9.0, 9.0]]),
            "frequency_change_std": (("level", "amplitude"), [[0.1, 0.1]]),
            "loss_factor": (("level", "amplitude"), [[4e-3, 5e-3]]),
            "loss_factor_std": (("level", "amplitude"), [[1e-5, 1e-5]]),
        },
        {"mode": ("level", ["2B"]), "force": ("level", [6e3])},
    )
    cards, rows, _ = front(stages)
    assert cards[1][1:] == (
        "1\u202f390 to 1\u202f400 Hz",
        ["loss factor 0.40 to 0.50 %", "over amplitude; no plateau is reached"],
    )
    assert "over amplitude, 2B" in rows
    del stages["curves"]
    assert front(stages)[0][1][1] == "no frequency"


def test_each_stage_leads_to_its_chapter_with_its_uncertainty(stages):
    _, rows, parts = front(stages)
    assert all(isinstance(row[0], Link) for row in rows.values())
    assert rows["stick frequency, 1B"][0].href == "report/stick.html"
    assert rows["stick frequency, 1B"][2] == "± 0.30 Hz"
    assert rows["records"][1] == "1 of 2 are used"
    each = rows["kn, kt force by force, s"]
    assert each[1:] == ["2 of 2 forces have a pair", "a factor of 7.4 and 7.4 either way"]
    assert rows["contact theory"][1] == "kn 1.30 and kt 1.30 GN/m"
    assert any(getattr(part, "lines", None) == ["r2: rejected: hum."] for part in parts)


def test_only_what_is_certain_is_called_named(stages):
    doubt = cause(("joint-slip", "none"), probability=0.85)
    said = verdict(causes=[cause(), doubt])
    row = front(stages, said=said)[1]["diagnosis, S"]
    assert row[1] == "cause named: load dependent stiffness"
    assert "joint slip (85 %) or nothing at all" in row[2]
    row = front(stages, said=verdict("ambiguous", [doubt]))[1]["diagnosis, S"]
    assert row[1] == "cause known up to a few: joint slip"


def test_curves_are_taken_where_they_could_be_used_else_the_frequencies_alone(stages):
    joints = [inference(3.0)]
    for amplitudes, kn, data in (
        ([inference(1.5, converged=1)], "1.50", "frequencies and curves"),
        ([inference(1.5, converged=0)], "3.00", "frequencies"),
        ([inference(1.5, law="", converged=1)], "3.00", "frequencies"),
    ):
        row = front(stages, joints, amplitudes)[1]["kn, kt together, s"]
        assert row[1].startswith(f"kn {kn} and kt ")
        assert row[1].endswith(f"GN/m at 12.1 kN, from {data}")
    assert "kn, kt together, s" not in front(stages, [inference(3.0, law="")])[1]


@pytest.mark.parametrize(("move", "foreign"), [(0.01, False), (-0.42, True)])
def test_a_structure_that_is_not_the_specimen_is_said(stages, move, foreign):
    missed = stages["stiffness"].assign(status=(("structure", "force"), [["no root"] * 2]))
    missed["needed_bias"] = (("structure", "force", "mode"), np.full((1, 2, 2), move))
    rows = front(stages | {"stiffness": missed})[1]
    text = rows["kn, kt force by force, s"][2]
    assert text.startswith(f"the model must move by {abs(100 * move):.2f} % or more")
    assert ("this structure is not the specimen" in text) == foreign
