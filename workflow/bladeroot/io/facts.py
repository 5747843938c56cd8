"""What each stage is told of a campaign besides measured numbers: one function a stage.

The workflow passes them on as JSON and `bladeroot.diagnose` as they are.
"""

from collections.abc import Mapping

from bladeroot.io.campaign import Campaign
from bladeroot.io.expected import expected_at
from bladeroot.io.load import load_facts
from bladeroot.io.overrides import overruled


def record_facts(campaign: Campaign, row: Mapping) -> dict:
    """What is known of a record besides its samples: its row, its mode, the other modes."""
    modes, load = campaign.description["modes"], campaign.load
    expected = {name: expected_at(one, load, row["load"]) for name, one in modes.items()}
    own_Hz = expected.pop(row["mode"])
    return {
        **row,
        **modes[row["mode"]],
        "expected_Hz": own_Hz,
        "other_modes_Hz": [*expected.values()],
        "simulated": campaign.simulated,
        "overruled": overruled(row),
        **load_facts(load),
    }


def observation_facts(campaign: Campaign) -> dict:
    """The gauge, where each mode is looked at (m), when each record began (s) and how warm (C)."""
    load = campaign.load
    placed = {mode: campaign.laser_x(mode) for mode in campaign.description["modes"]}

    def said(column: str) -> dict[str, float]:
        return {r["record"]: r[column] for r in campaign.records if r[column] is not None}

    return {
        "same_everywhere": load.same_everywhere if load else 0.0,
        "of_reading": load.of_reading if load else 0.0,
        "scale": campaign.force_scale if load else 0.0,
        "laser_x": {mode: x for mode, x in placed.items() if x is not None},
        "time": said("time_s"),
        "temperature": {} if load and load.unit == "C" else said("temperature_C"),
    }


def diagnosis_facts(campaign: Campaign, config: Mapping) -> dict:
    """The model's bias, where contact is full, what else was measured."""
    described, load = campaign.description, campaign.load
    return {
        **config["diagnosis"],
        **config["search"],
        "expected_Hz": {m: expected_at(one, load, None) for m, one in described["modes"].items()},
        "structure_lacks": campaign.structure_lacks,
        "load": {"name": load.name, "unit": load.unit, "given": load.given} if load else None,
        "full_contact_from_kN": described.get("full_contact_from_kN", 0),
        "costs": described.get("costs", {}),
        "independent": described.get("independent", []),
    }
