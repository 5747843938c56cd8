"""What the report and its figures say of the nonlinear joint follows from the numbers."""

import numpy as np
import pytest
import xarray as xr
from bladeroot.figures import nonlinear as figures
from bladeroot.figures.chart import Chart
from bladeroot.figures.still import still
from bladeroot.report.nonlinear import nonlinear_section

NAN = np.nan


def table(onset, partial, reason=""):
    """Onsets (um) by exponents 0, 0.5 and 1; of partial contact by two parts of the load."""
    attrs = {"structure": "S", "mode": "1B", "friction": 0.42, "force_N": 4e3, "kn": 5e8,
             "kt": 9e8, "seen_m": 2e-6, "reason": reason}  # fmt: skip
    if reason:
        return xr.Dataset(attrs=attrs)
    return xr.Dataset(
        {
            "first_slip": ("exponent", 1e-6 * np.array([190.0, 10.0, 1.0])),
            "onset": ("exponent", 1e-6 * np.array(onset)),
            "partial_onset": (("share", "loose"), 1e-6 * np.array([partial])),
            "highest": 4e-4,
        },
        {"exponent": [0.0, 0.5, 1.0], "share": [0.8], "loose": [0.02, 0.01]},
        attrs,
    )


def said(found):
    return nonlinear_section([], [found], [], of_the_thesis=True).parts[0]


@pytest.mark.parametrize(
    ("onset", "partial", "texts"),
    [
        ((200, 20, 1), (4, 1.9), ("80 % of the width bearing all but 1 % of the load: 1.9 µm",)),
        ((200, 20, 2.1), (4, 1), ("nearest comes contact with exponent 1: 2.1 µm",)),
        ((NAN, NAN, 50), (NAN, NAN), ("exponent 1: 50 µm",)),
        ((NAN, NAN, NAN), (NAN, NAN), ("no contact that was tried lets it fall up to 400 µm",)),
    ],
)
def test_the_contact_that_comes_nearest_to_what_was_seen_is_named(onset, partial, texts):
    words = said(table(onset, partial))
    for text in texts:
        assert text in words
    assert "nan" not in words


def inference(**attrs):
    """An inference with curves of one mode at two forces; 2B has none."""
    of_k, point = ("force", "stiffness"), ("point", np.array([-0.01, -0.02, -0.04]))
    k = np.full((2, 2, 3), 1e9) * [0.5, 1.0, 2.0]
    line = np.stack([np.linspace(0.0, -0.05, 4)] * 2 + [np.full(4, np.nan)] * 2)
    shown = {"picture_mode": "1B", "picture_force_N": 4e3}
    return xr.Dataset(
        {
            "k_quantile": ((*of_k, "quantile"), k),
            "frequencies_k_quantile": ((*of_k, "quantile"), k),
            **{name: (of_k, np.full((2, 2), 0.3)) for name in ("ln_std", "frequencies_ln_std")},
            "shrinkage": (of_k, np.full((2, 2), 1.5)),
            "area_shrinkage": ("force", [2.0, 2.0]),
            "correlation": ("force", [-0.9, -0.9]),
            **{f"friction_{name}": ("friction", [0.3]) for name in
               ("value", "ln_std", "prior", "prior_ln_std")},
            "friction_origin": ("friction", ["steel"]),
            "point_mode": ("point", ["1B"] * 3),
            "point_force": ("point", [4e3, 4e3, 8e3]),
            "point_amplitude": ("point", [3e-6, 6e-6, 9e-6]),
            "fall": point, "rise": ("point", -point[1]),
            "fall_simulated": ("point", point[1] + 2e-3),
            "rise_simulated": ("point", 3e-3 - point[1]),
            "fall_std": ("point", np.full(3, 1e-3)), "rise_std": ("point", np.full(3, 1e-3)),
            "level_mode": ("level", ["1B", "1B", "2B", "2B"]),
            "level_force": ("level", [4e3, 8e3] * 2),
            "map_fall": (("level", "amplitude"), line),
            "map_rise": (("level", "amplitude"), -line),
            "loop_motion": (("picture_amplitude", "sample"), np.zeros((1, 3))),
            "loop_force": (("picture_amplitude", "sample"), np.zeros((1, 3))),
            "slip": (("picture_amplitude", "pair"), np.zeros((1, 2))),
            "pair_flank": ("pair", [0, 0]),
            "pair_along": (("pair", "direction"), np.eye(2)),
        },
        {
            "force": [4e3, 8e3], "stiffness": ["kn", "kt"], "quantile": [0.025, 0.5, 0.975],
            "friction": ["friction"], "amplitude": np.geomspace(1e-6, 1e-5, 4),
            "picture_amplitude": [1e-5],
        },
        {"structure": "S", "law": "two powers", "discrepancy": 0.05, "converged": 1,
         "left_out": "", **shown, **attrs},
    )  # fmt: skip


def words(*found):
    parts = nonlinear_section(found, [], [], of_the_thesis=True).parts
    return " ".join(part for part in parts if isinstance(part, str))


def test_curves_that_were_not_used_are_named_with_the_reason():
    assert "S: without the curves of 2B: at a node." in words(inference(left_out="2B: at a node"))
    assert "without the curves" not in words(inference())
    empty = xr.Dataset(attrs={"structure": "S", "law": "", "reason": "none falls"})
    assert words(empty) == "S: no curves were used: none falls."


@pytest.mark.parametrize("draw", [figures.curves, figures.slip])
def test_figures_of_a_fit_that_did_not_converge_say_so(draw):
    for one, text in ((inference(), ""), (inference(converged=0), "S: the fit did NOT converge")):
        made = draw(one, True)
        figure = still(made) if isinstance(made, Chart) else made
        assert figure.get_supxlabel().startswith(text)
        assert bool(figure.get_supxlabel()) == bool(text)
