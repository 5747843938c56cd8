"""A trial of a mechanism's law on a few records, so that a faulty one is told before any fit."""

import numpy as np

from bladeroot.mechanisms.mechanism import COORDINATES, Mechanism, Points, Records

_RECORDS = Records(
    mode=np.array([0, 1, 0, 1]),
    force=np.array([2e3, 2e3, 2e4, 2e4]),
    sign=np.array([1.0, 1.0, -1.0, -1.0]),
    time=np.array([0.0, 200.0, 2000.0, 2200.0]),
    since=np.array([0.0, 200.0, 0.0, 200.0]),
    span=2200.0,
    hold_span=200.0,
)
_POINTS = Points(
    mode=np.array([0, 0, 1, 1]),
    force=np.array([2e3, 2e4, 2e3, 2e4]),
    amplitude=np.array([1e-7, 1e-5, 1e-7, 1e-5]),
    loss=np.full(4, 4e-3),
)


def probe(one: Mechanism) -> None:
    """Raise ValueError where `stick`, `damping` or `curve` return what no fit can use.

    Tried at the prior's mean and at each start. Whatever the law itself throws is passed on.
    """
    for start in (one.start, *one.starts):
        values, _ = one.values(np.asarray(start, float))
        if one.stick is not None:
            effect = one.stick(_RECORDS, values)
            unknown = (set(effect.changes) | set(effect.slopes)) - set(COORDINATES)
            if unknown or set(effect.changes) != set(effect.slopes):
                raise ValueError(f"changes and slopes must both be of {', '.join(COORDINATES)}")
            for name, change in effect.changes.items():
                _agree(name, change, effect.slopes[name], values.size)
        if one.damping is not None:
            _agree("damping", *one.damping(_RECORDS, values), values.size)
        if one.curve is not None:
            effect = one.curve(_POINTS, values)
            _agree("ln_f", effect.ln_f, effect.ln_f_slope, values.size)
            _agree("loss", effect.loss, effect.loss_slope, values.size)


def _agree(name: str, change: np.ndarray, slope: np.ndarray, count: int) -> None:
    shapes = np.shape(change), np.shape(slope)
    wanted = (4,), (4, count)
    if shapes != wanted:
        raise ValueError(f"{name}: expected shapes {wanted} on 4 records, got {shapes}")
    if not (np.isfinite(change).all() and np.isfinite(slope).all()):
        raise ValueError(f"{name}: not finite at the parameters that are expected")
