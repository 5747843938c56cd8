"""What a cause found in the thesis's data says of its Table 5.2 and of contact theory."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from bladeroot.report.numbers import fixed, listed
from bladeroot.report.verdict import with_open

CAUSE = "load-dependent-stiffness"


def exponent(force: np.ndarray, stiffness: np.ndarray) -> float:
    """Exponent of the nearest power law of the force; NaN with fewer than two points."""
    known = np.isfinite(stiffness)
    if known.sum() < 2:
        return np.nan
    return float(np.polyfit(np.log(force[known]), np.log(stiffness[known]), 1)[0])


def table_5_2_remarks(
    verdicts: Sequence[Mapping], stiffness: xr.Dataset, theory: xr.Dataset
) -> list[str]:
    """A paragraph where load-dependent stiffness was named with any structure, else nothing."""
    sizes = []
    for said in verdicts:
        for cause in with_open(said)["causes"]:
            if cause["mechanism"] == CAUSE:
                p = cause["parameters"][0]
                sizes.append((p["value"], p["std"], str(said["structure"])))
    if not sizes:
        return []
    force = stiffness["force"].values
    table = [exponent(force, stiffness[f"published_{k}_total"].values) for k in ("kn", "kt")]
    alone = theory.isel(friction_state=0)  # T = 0
    smooth = [exponent(alone["force"].values, alone[f"{k}_theory"].values) for k in ("kn", "kt")]
    given = listed([f"{fixed(v, 2)} ± {fixed(s, 2)} with {name}" for v, s, name in sizes])
    text = (
        "What this means for Table 5.2 and chapter 6. In Table 5.2 kn and kt grow with the force "
        f"by exponents {fixed(table[0], 2)} and {fixed(table[1], 2)}; by the theory of chapter 6, "
        f"for smooth flanks, by {fixed(smooth[0], 2)} and {fixed(smooth[1], 2)}. The measured "
        f"frequencies ask for {given}. "
    )
    low = min(v - 2.0 * s for v, s, _ in sizes)
    text += (
        "Unless a cause that was not judged is at work, the growth in Table 5.2 is in the data and "
        "not only in its search, and smooth flanks "
        "do not explain it"
        if low > max(smooth)
        else "With some geometry that does not exclude smooth contact"
    )
    named = {name for _, _, name in sizes}
    others = [str(said["structure"]) for said in verdicts if str(said["structure"]) not in named]
    if others:
        text += f"; with {listed(others)} this cause is not named"
    return [text + "."]
