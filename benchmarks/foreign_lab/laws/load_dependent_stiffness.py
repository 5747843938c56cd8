"""Contact stiffness grows with the load, as rough surfaces' and round ones' does."""

import numpy as np

ID, UNIT = "load-dependent-stiffness", "d ln k / d ln F at the middle load"
SIZES = (0.15, 0.75)


def _unlike(rng) -> dict:
    return {"kt_over_kn": float(rng.uniform(0.7, 1.3))}


FORMS = {
    "power": _unlike,
    "layer-and-bulk": lambda r: _unlike(r) | {"layer": float(r.uniform(0.6, 1.0))},
    "hertz-and-bulk": lambda r: _unlike(r) | {"layer": 1.0 / 3.0},
    "saturating": lambda r: _unlike(r) | {"bend": float(r.uniform(0.8, 1.6))},
}


def ln_stiffness(form: str, shape: dict, slope: float, load: np.ndarray) -> np.ndarray:
    """ln k over the load (1 at the middle), 0 there, with the given slope there."""
    load = np.maximum(load, 0.02)
    if form == "power":
        return slope * np.log(load)
    if form == "saturating":  # the slope fades with the load
        bend = shape["bend"]
        return slope * (1 - load**-bend) / bend
    # compliance 1/bulk + 1/(c F^layer): the layer's part of it at the middle makes the slope
    part = min(slope / shape["layer"], 0.97)
    return -np.log((1 - part) + part * load ** -shape["layer"])


def stick(effect, sheet):
    """kn and kt by the same form, with slopes that differ."""
    load = sheet.state["force"] / sheet.reference
    ratio = effect.shape["kt_over_kn"]
    return {
        "ln_kn": ln_stiffness(effect.form, effect.shape, effect.size, load),
        "ln_kt": ln_stiffness(effect.form, effect.shape, ratio * effect.size, load),
    }


def measures(effect, sheet):
    """Slope of ln k over ln F at 12 kN, where the product states it: mean of kn's and kt's."""
    ends = 12e3 * np.exp([-1e-4, 1e-4]) / sheet.reference
    slopes = [
        np.diff(ln_stiffness(effect.form, effect.shape, ratio * effect.size, ends))[0] / 2e-4
        for ratio in (1.0, effect.shape["kt_over_kn"])
    ]
    return {"slope": float(np.mean(slopes))}
