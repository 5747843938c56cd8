"""Axial force that relaxes after a hold is set."""

from dataclasses import replace

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records, StickEffect

# `loss` is in each form the loss in a decade of the time since the clamping, at ten minutes.
_STATED_S = 600.0
# Nobody states how long after the clamping the first record is: in one form it is a parameter, in
# the other logarithmic one and the power law it is the time constant, in the stretched one this.
_FIRST_RECORD_S = 120.0


def logarithmic(records: Records, values: np.ndarray) -> StickEffect:
    """F (1 - loss log10(1 + t/tau)) with the time t since the first record of the hold."""
    loss, tau = values
    decades = np.log10(1.0 + records.since / tau)
    slope = -records.since / (tau * (tau + records.since)) / np.log(10.0)
    return _effect(records, decades, loss, loss * slope)


def from_setting(records: Records, values: np.ndarray) -> StickEffect:
    """The same from the moment of setting, at which the force is read: some minutes before."""
    loss, tau, before = values
    since, scale = records.since + before, 1.0 + tau / _STATED_S
    decades = np.log10(1.0 + since / tau)
    by_before = loss * scale / ((tau + since) * np.log(10.0))
    by_tau = loss * decades / _STATED_S - by_before * since / tau
    return _effect(records, scale * decades, loss, by_tau, by_before)


def stretched(records: Records, values: np.ndarray) -> StickEffect:
    """F (1 - c (exp(-(t0/tau)^beta) - exp(-((t0 + t)/tau)^beta))), t0 being two minutes."""
    loss, tau, beta = values
    ends = np.array([np.zeros(records.since.size), records.since]) + _FIRST_RECORD_S
    power = (ends / tau) ** beta
    left, stated = np.exp(-power), (_STATED_S / tau) ** beta
    scale = np.exp(stated) / (beta * stated * np.log(10.0))
    first, last = power * left
    by_beta = np.diff(power * left * np.log(ends / tau), axis=0)[0]
    gone = left[0] - left[1]
    return _effect(
        records, scale * gone, loss,
        loss * scale * beta / tau * (first - last + (1.0 - stated) * gone),
        loss * scale * (by_beta + ((stated - 1.0) * np.log(_STATED_S / tau) - 1.0 / beta) * gone),
    )  # fmt: skip


def power(records: Records, values: np.ndarray) -> StickEffect:
    """F (1 - c (1 - (1 + t/tau)^-p)): a fall that slows down over the decades."""
    loss, tau, order = values
    ln, late = np.log1p(records.since / tau), np.log(_STATED_S / tau)
    left = np.exp(-order * ln)
    scale = np.exp(order * late) / (order * np.log(10.0))
    course = scale * (1.0 - left)
    by_tau = -scale * order * records.since / (tau * (tau + records.since)) * left
    by_order = course * (late - 1.0 / order) + scale * left * ln
    return _effect(records, course, loss, loss * (by_tau - course * order / tau), loss * by_order)


def _effect(records: Records, course: np.ndarray, loss: float, *slopes: np.ndarray) -> StickEffect:
    force = records.force
    columns = np.stack([course, *slopes], axis=1)
    return StickEffect({"force": -loss * course * force}, {"force": -columns * force[:, None]})


_LOSS = Parameter(
    "loss", "1", 0.01, 1.2, 1e-5, 0.2,
    "a decade of time, at ten minutes: a hydraulic hold loses tenths of a per cent to some",
    log=True,
)  # fmt: skip
_TIME = Parameter(
    "time_constant", "s", 120.0, 1.2, 1.0, 1e5,
    "from seconds (seats) to an hour (leakage)", log=True,
)  # fmt: skip
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
    "logarithmic, from the setting",
    Parameter("before", "s", 120.0, 1.0, 1.0, 1e4, "minutes to prepare a record", log=True),
    stick=from_setting,
).also(
    "stretched", replace(_TIME, mean=600.0, low=60.0),
    Parameter("stretch", "1", 0.7, 1.0, 0.2, 1.05, "1 a single time", bounded=True),
    keep=1, stick=stretched,
).also(
    "power", Parameter("order", "1", 0.5, 0.5, 0.02, 5.0, "power of time", log=True), stick=power
)  # fmt: skip
