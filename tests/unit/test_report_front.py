"""The report's first section: kn and kt from all forces together."""

import numpy as np
import pytest
import xarray as xr
from bladeroot.report.summary import summary_section

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
    stick = xr.Dataset(
        {
            "frequency": ("level", [480.0, 560.0, 1300.0, 1480.0]),
            "mode": ("level", ["1B", "1B", "2B", "2B"]),
            "force": ("level", [6e3, 12e3] * 2),
            "verdict": ("record", np.zeros(0, str)),
        },
        {"record": np.zeros(0, str)},
    )
    stiffness = xr.Dataset(
        {
            "status": (("structure", "force"), [["root", "root"]]),
            **{name: (("structure", "force"), [[1e9, 2e9]]) for name in ("kn", "kt")},
            **{f"ln_{n}_std": (("structure", "force"), [[2.0, 2.0]]) for n in ("kn", "kt")},
        },
        {"structure": ["s"], "force": [6e3, 12e3]},
    )
    theory = xr.Dataset(
        {
            **{f"{name}_theory": ("force", [1.3e9, 1.3e9]) for name in ("kn", "kt")},
            **{f"{name}_published_ratio": ("force", [np.nan] * 2) for name in ("kn", "kt")},
        }
    )
    return stick, stiffness, theory


def said(stages, joints, amplitudes):
    parts = summary_section(*stages, joints, amplitudes, of_the_thesis=False).parts
    return [part for part in parts if "together" in part]


def test_curves_are_taken_where_they_could_be_used(stages):
    (text,) = said(stages, [inference(3.0)], [inference(1.5, converged=1)])
    assert "frequencies and amplitude curves of all forces together, at 12.1 kN" in text
    assert "kn 1.50 (0.750 to 3.00) GN/m" in text
    assert "kt 3.00 (1.50 to 6.00) GN/m" in text


@pytest.mark.parametrize("curves", [{"law": ""}, {"converged": 0}])
def test_else_the_frequencies_alone(stages, curves):
    (text,) = said(stages, [inference(3.0)], [inference(1.5, **({"converged": 1} | curves))])
    assert text.startswith("From the frequencies of all forces together")
    assert "kn 3.00 (1.50 to 6.00) GN/m" in text
    assert not said(stages, [inference(3.0, law="")], [])


@pytest.mark.parametrize(("move", "foreign"), [(0.01, False), (-0.42, True)])
def test_a_structure_that_is_not_the_specimen_is_said(stages, move, foreign):
    stick, stiffness, theory = stages
    stiffness["status"] = (("structure", "force"), [["no root", "no root"]])
    for name, value in (("needed_bias", move), ("fe_bias_std", 0.005)):
        one = np.full((1, 2, 2), value)
        stiffness[name] = (("structure", "force", "mode"), one, {"units": "1"})
    stiffness = stiffness.assign_coords(mode=["1B", "2B"])
    text = " ".join(summary_section(stick, stiffness, theory, [], [], False).parts)
    assert ("this structure is not the specimen" in text) == foreign
