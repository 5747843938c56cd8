"""Axial force that relaxes after a hold is set."""

from dataclasses import replace

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records, StickEffect


def logarithmic(records: Records, values: np.ndarray) -> StickEffect:
    """F (1 - loss log10(1 + t/tau)) with the time t since the first record of the hold."""
    loss, tau = values
    decades = np.log10(1.0 + records.since / tau)
    slope = -records.since / (tau * (tau + records.since)) / np.log(10.0)
    return _effect(records, decades, loss, loss * slope)


def stretched(records: Records, values: np.ndarray) -> StickEffect:
    """F (1 - c (1 - exp(-(t/tau)^beta))), c so that `loss` is the steepest fall a decade."""
    loss, tau, beta = values
    scale = np.e / (beta * np.log(10.0))
    ratio = np.maximum(records.since / tau, 1e-12)
    power = ratio**beta
    gone = -np.expm1(-power)
    steep = power * np.exp(-power)  # d gone / d ln(power)
    return _effect(
        records, scale * gone, loss, -loss * scale * steep * beta / tau,
        loss * scale * (steep * np.log(ratio) - gone / beta),
    )  # fmt: skip


def power(records: Records, values: np.ndarray) -> StickEffect:
    """F (1 + t/tau)^-p with p = loss / ln 10: a fall that slows down over the decades."""
    loss, tau, order = values
    ln = np.log1p(records.since / tau)
    left = np.exp(-order * ln)
    course = (1.0 - left) / (order * np.log(10.0))
    by_tau = -records.since / (tau * (tau + records.since)) * left / np.log(10.0)
    by_order = (left * ln / order - (1.0 - left) / order**2) / np.log(10.0)
    return _effect(records, course, loss, loss * by_tau, loss * by_order)


def _effect(records: Records, course: np.ndarray, loss: float, *slopes: np.ndarray) -> StickEffect:
    force = records.force
    columns = np.stack([course, *slopes], axis=1)
    return StickEffect({"force": -loss * course * force}, {"force": -columns * force[:, None]})


_LOSS = Parameter(
    "loss", "1", 0.0, 0.01, 0.0, 0.2,
    "a decade of time, where steepest: a hydraulic hold loses tenths of a per cent to some",
)  # fmt: skip
_TIME = Parameter(
    "time_constant", "s", 60.0, 1.2, 1.0, 1e5, "from seconds (seats) to an hour (leakage)", log=True
)
MECHANISM = Mechanism(
    id="force-relaxation",
    kind="time",
    sentence="after each setting the {load} relaxes, by oil leakage or creep of the seats",
    parameters=(_LOSS, _TIME),
    splitter="the {force} read at each record; a clamping kept for an hour",
    stick=logarithmic,
    over=("since",),
    form="logarithmic",
).also(
    "stretched", replace(_TIME, mean=300.0),
    Parameter("stretch", "1", 0.7, 1.0, 0.2, 1.05, "1 a single time", bounded=True),
    keep=1, stick=stretched,
).also(
    "power", Parameter("order", "1", 0.5, 0.5, 0.02, 5.0, "power of time", log=True), stick=power
)  # fmt: skip
