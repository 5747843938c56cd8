"""The parametric model of a joint is made, once for each structure; `parametric` reads it."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.rom.chebyshev import Surface
from bladeroot.rom.chebyshev_fit import fit
from bladeroot.rom.greedy import error_bound, find_bases
from bladeroot.rom.joint import Joint, exact_modes
from bladeroot.rom.parametric import frequencies, spring_names
from bladeroot.rom.ritz import Ritz, frequency, solve

MODES = ("1B", "2B")
STIFFNESS = (1e8, 1e12)  # N/m, flank totals; the thesis searched 3.3e8 to 5e9
FORCE = (0.0, 30e3)  # N
TOLERANCE = 1e-7  # of the frequency, against the whole joint
# The final check, at random points of the box.
_CHECK_POINTS = 500  # at which the bound is evaluated
_EXACT_POINTS = 6  # of these that are solved exactly
# Projections in the artifact: dims besides mode, unit, what it is.
SQUARE = ("vector", "vector_")
PROJECTIONS = {
    "beam": (SQUARE, "s-2", "projected stiffness of the beam without force"),
    "slots": (SQUARE, "s-2", "projected stiffness of the slots"),
    "geometric": (SQUARE, "s-2 N-1", "projected geometric stiffness per newton of axial force"),
    "beam_mass": (SQUARE, "1", "the beam's share of the projected mass, which is the identity"),
    "contact": (
        ("pair", "local", "vector"),
        "kg-1/2",
        "motion of the beam against the slot at each contact pair per basis vector",
    ),
    "display": (
        ("display", "axis", "vector"),
        "kg-1/2",
        "motion of the display nodes per basis vector",
    ),
    "residual": (("part", "part_"), "s-1", "factor of the residual's dual norm"),
}


def parametric_model(
    joint: Joint,
    modes: Sequence[str] = MODES,
    stiffness: tuple[float, float] | Float[ndarray, "parameter 2"] = STIFFNESS,
    force: tuple[float, float] = FORCE,
    tolerance: float = TOLERANCE,
    sums: bool = True,
) -> xr.Dataset:
    """Build the model of the named modes over a box of contact stiffness (N/m) and load.

    stiffness: ends of every stiffness, or of each in the order of the joint's parameters. sums:
    whether Chebyshev sums are made, which take two stiffnesses.

    tolerance: largest relative error of a frequency against the whole joint that the bound of the
    bases may leave at their training points. `error_bound` of the result adds what the Chebyshev
    sums leave out, at random points that neither has seen; `check_error` is the error against exact
    solutions at some of them. Raises ValueError if the box is empty, a mode is not found or not
    followed through it, or the tolerance cannot be reached.
    """
    ends = np.broadcast_to(np.asarray(stiffness, float), (len(joint.rows), 2))
    for one in ends:
        if not 0.0 < one[0] < one[1]:
            raise ValueError(f"the box of stiffness must be 0 < low < high N/m, got {tuple(one)}")
    if not force[0] < force[1]:
        raise ValueError(f"the box of the load must be low < high, got {force}")
    low, high = (np.append(np.log(ends[:, k]), force[k]) for k in (0, 1))
    ritzes, solutions = find_bases(joint, modes, low, high, tolerance)
    surface = Surface(np.zeros((0, 0, 0, 0)), low, high)
    if sums:
        surface = fit(
            lambda points: np.stack([np.log(frequency(solve(m, points).value)) for m in ritzes]),
            low,
            high,
            tolerance / 10.0,
        )
    return _dataset(joint, list(modes), ritzes, surface).assign_attrs(
        tolerance=tolerance, exact_solutions=solutions
    )


def _checks(joint: Joint, modes: list[str], ritzes: list[Ritz], surface: Surface) -> dict:
    """Bound and errors at random points; the first of them are corners of the stiffness."""
    low, high = surface.low, surface.high
    unseen = np.random.default_rng(4).uniform(low, high, (_CHECK_POINTS, len(low)))
    unseen[:4, :2] = [(a, b) for a in (low[0], high[0]) for b in (low[1], high[1])]
    projected = np.stack([frequency(solve(one, unseen).value) for one in ritzes])
    fast = frequencies(surface, unseen).T if surface.coefficients.size else projected
    bound = np.stack([error_bound(one, unseen) for one in ritzes])
    exact = [frequency(exact_modes(joint, point, modes).values) for point in unseen[:_EXACT_POINTS]]
    exact = np.stack(exact, axis=1)
    return {
        "error_bound": (bound + np.abs(fast / projected - 1.0)).max(axis=1),
        "basis_bound": bound.max(axis=1),
        "check_point": unseen[:_EXACT_POINTS],
        "check_frequency": exact,
        "check_error": fast[:, :_EXACT_POINTS] / exact - 1.0,
    }


def _dataset(joint: Joint, modes: list[str], ritzes: list[Ritz], surface: Surface) -> xr.Dataset:
    def var(dims, values, units: str, long_name: str, source: str = "") -> tuple:
        attrs = {"units": units, "long_name": long_name}
        return (dims, values, attrs | ({"source": source} if source else {}))

    springs = spring_names(len(joint.rows))
    parts = [vars(one) | dict(zip(springs, one.springs, strict=True)) for one in ritzes]
    text = "factor of the projected contact matrix of unit stiffness"
    projections = PROJECTIONS | dict.fromkeys(springs, (SQUARE, "kg-1/2", text))
    entries = {
        name: var(("mode", *dims), _padded([one[name] for one in parts]), unit, text)
        for name, (dims, unit, text) in projections.items()
    }
    checks = _checks(joint, modes, ritzes, surface)
    orders = ("order_kn", "order_kt", "order_force")
    mixed = "N/m in logarithm, N"
    if surface.coefficients.size:
        entries["ln_frequency"] = var(
            ("mode", *orders),
            surface.coefficients,
            "1",
            "Chebyshev coefficients of ln(f / Hz) over the box",
            "eq. 5.4",
        )
    entries |= {
        "box": var(
            ("end", "coordinate"), np.stack([surface.low, surface.high]), mixed, "ends of the box"
        ),
        "vectors": var("mode", [len(one.beam) for one in ritzes], "1", "vectors of the basis"),
        "own": var("mode", [one.own for one in ritzes], "1", "of these, not for perturbations"),
        "rank": var("mode", [one.rank for one in ritzes], "1", "lower modes in the same basis"),
        "amplification": var(
            "mode", [one.amplification for one in ritzes], "1", "error's growth by the next mode"
        ),
        "display_x": var("display", ritzes[0].display_x, "m", "position on the display line"),
        "error_bound": var(
            "mode",
            checks["error_bound"],
            "1",
            f"largest bound of the relative error of frequency at {_CHECK_POINTS} random points",
        ),
        "basis_bound": var("mode", checks["basis_bound"], "1", "the same of the basis alone"),
        "check_point": var(("check", "coordinate"), checks["check_point"], mixed, "checked points"),
        "check_frequency": var(
            ("mode", "check"), checks["check_frequency"], "Hz", "exact frequency of the joint there"
        ),
        "check_error": var(
            ("mode", "check"), checks["check_error"], "1", "relative error of the model there"
        ),
    }
    return xr.Dataset(
        entries,
        coords={
            "mode": modes,
            "coordinate": [*(f"ln_{name}" for name in joint.parameters), "force"],
            "axis": list("XYZ"),
            "local": ["normal", "along Y", "along slope"],
        },
        attrs={
            "structure": joint.assembly.attrs["structure"],
            "springs": joint.springs,
        },
    )


def _padded(blocks: list[ndarray]) -> ndarray:
    """Blocks of several sizes in one array, filled up with zeros; `ritz_of` cuts them off again."""
    shape = np.max([block.shape for block in blocks], axis=0)
    whole = np.zeros((len(blocks), *shape))
    for place, block in zip(whole, blocks, strict=True):
        place[tuple(slice(0, n) for n in block.shape)] = block
    return whole
