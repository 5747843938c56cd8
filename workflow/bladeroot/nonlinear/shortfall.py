"""Where slip begins against how pressure is spread over the flanks, and what the source saw.

With uniform pressure and Coulomb friction nothing slips before a whole flank is near slipping. The
source sees frequency fall from a fiftieth of that amplitude on (sections 3.5, 6.2). This asks which
pressure would do that: less of it at the edges, by an exponent, or contact on a part of the flank.
"""

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.laws.distributed import distributed
from bladeroot.contact.laws.jenkins import jenkins
from bladeroot.contact.laws.profiles import Profile, power_profile
from bladeroot.nonlinear.curves import first_slip
from bladeroot.nonlinear.fast_loading import softening_curve
from bladeroot.nonlinear.flanks import even_preload, width_places
from bladeroot.nonlinear.system import system_of
from bladeroot.rom.joint import Joint
from bladeroot.variables import dataset

# The onset of slip that the source sees, and how it is read off a simulated curve.
SEEN_ONSET = 2e-6  # m at the laser, section 3.5
ONSET_FALL = 2e-4  # relative fall of the frequency at the onset: the source reads it off a curve
# The joint that is simulated.
MODE = "1B"
FRICTION = 0.42  # coefficient
# ln kn, ln kt (N/m) and F (N); kn and kt as they fit measured frequencies near 4 kN.
POINT = np.array([np.log(0.5e9), np.log(0.9e9), 4e3])
# The pressures over a flank's width that are tried.
EXPONENTS = (0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5)  # over the whole width; 0 uniform, 0.5 elliptic
WIDTH_SHARES = (0.95, 0.9, 0.8, 0.6)  # of the width in the middle, where contact is partial
LOOSE_SHARES = (0.05, 0.02, 0.01, 0.005)  # of the load that stays spread over the whole width then
_STRIPS = 12  # of each pair across the width, each with its own pressure


def onset_table(joint: Joint, point: Float[ndarray, "3"], laser_x: float = 0.0) -> xr.Dataset:
    """Amplitudes (m) at the laser where the first place slips and where the frequency has fallen.

    point: (ln kn, ln kt, F). By `exponent` of the pressure over the whole width (0 uniform, 0.5
    elliptic); and for partial contact by the `share` of the width that bears the load evenly, but
    for the part `loose` of it that stays spread over all, so that the joint still sticks at rest.

    Where the curves cannot be simulated the table is empty and its `reason` says why.
    """
    attrs = {
        "structure": joint.assembly.attrs["structure"],
        "mode": MODE,
        "friction": FRICTION,
        "force_N": float(point[2]),
        "kn": float(np.exp(point[0])),
        "kt": float(np.exp(point[1])),
        "seen_m": SEEN_ONSET,
        "reason": "",
    }
    try:
        return _onsets(joint, point, laser_x).assign_attrs(attrs)
    except (ValueError, RuntimeError) as error:
        return xr.Dataset(attrs=attrs | {"reason": str(error)})


def _onsets(joint: Joint, point: Float[ndarray, "3"], laser_x: float) -> xr.Dataset:
    system = system_of(joint, point, MODE, laser_x)
    whole = jenkins(
        *system.stiffness.T, even_preload(joint, float(point[2]))[system.pair], FRICTION
    )
    place = width_places(joint)[system.pair]
    uniform = first_slip(system, whole)
    ladder = np.geomspace(1e-4 * uniform, 2.0 * uniform, 130)

    def onsets(profile: Profile) -> tuple[float, float]:
        sliders = distributed(whole, place, profile, _STRIPS)
        fall = -softening_curve(system, sliders, ladder)[0][0]
        return first_slip(system, sliders), crossing(ladder, fall, ONSET_FALL)

    full = np.array([onsets(power_profile(exponent)) for exponent in EXPONENTS])
    even = power_profile(0.0)
    partial = np.array(
        [
            [onsets(partial_contact(even, share, loose)) for loose in LOOSE_SHARES]
            for share in WIDTH_SHARES
        ]
    )
    made = {
        "first_slip": full[:, 0],
        "onset": full[:, 1],
        "partial_first_slip": partial[..., 0],
        "partial_onset": partial[..., 1],
        "highest": ladder[-1],
    }
    places = {"exponent": EXPONENTS, "share": WIDTH_SHARES, "loose": LOOSE_SHARES}
    return dataset("nonlinear/shortfall", made | {k: list(v) for k, v in places.items()})


def crossing(
    ladder: Float[ndarray, " amplitude"], fall: Float[ndarray, " amplitude"], level: float
) -> float:
    """Amplitude at which a fall first exceeds a level, between the ladder's points; NaN if at none.

    The first point, if there already.
    """
    past = np.flatnonzero(fall > level)
    if not len(past):
        return np.nan
    at = np.array([past[0] - 1, past[0]]).clip(min=0)
    return float(np.exp(np.interp(level, fall[at], np.log(ladder[at]))))


def partial_contact(inner: Profile, share: float, loose: float) -> Profile:
    """A profile on the middle `share` of the width; a part `loose` of the load is uniform on all.

    Raises ValueError unless 0 < share <= 1 and 0 <= loose < 1.
    """
    if not (0.0 < share <= 1.0 and 0.0 <= loose < 1.0):
        raise ValueError(f"expected a share in (0, 1] and loose in [0, 1), got {share}, {loose}")
    rim = 0.5 * (1.0 - share)

    def profile(place):
        within = np.clip((np.asarray(place, float) - rim) / share, 0.0, 1.0)
        return loose * np.asarray(place, float) + (1.0 - loose) * inner(within)

    return profile
