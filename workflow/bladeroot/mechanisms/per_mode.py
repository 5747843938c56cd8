"""A law of a first mode and another, for any number of modes: each has ratios of its own.

Not a mechanism itself. What a mode has of the joint's slip, of a stretch or of a drag is by its
shape: a third mode is no more like the second than like the first.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Int
from numpy import ndarray

from bladeroot.mechanisms.mechanism import CurveEffect, Mechanism, Points, Records, rows_of


def of_modes(one: Mechanism, count: int) -> Mechanism:
    """The mechanism with its parameters of kind `ratio` once for each mode from the second on.

    Those of further modes come last, named by the mode's number (`ratio_3`).
    """
    forms = tuple(of_modes(form, count) for form in one.forms)
    ratio = np.array([p.ratio for p in one.parameters])
    further = range(2, count)
    if not (ratio.any() and further):
        return replace(one, forms=forms)
    own = tuple(
        replace(p, name=f"{p.name}_{mode + 1}", number=mode)
        for mode in further
        for p in one.parameters
        if p.ratio
    )
    places = np.tile(np.arange(ratio.size), (count, 1))
    places[2:, ratio] = ratio.size + np.arange(len(own)).reshape(len(further), -1)
    starts = tuple((*s, *np.tile(np.array(s)[ratio], len(further)).tolist()) for s in one.starts)
    return replace(
        one, parameters=(*one.parameters, *own), forms=forms, starts=starts,
        curve=one.curve and _curve(one.curve, places),
        damping=one.damping and _damping(one.damping, places),
    )  # fmt: skip


def modes_of(one: Mechanism, names: set[str]) -> int:
    """For how many modes (at least two) a mechanism's parameters of such names are."""
    count = 2
    while any(p.ratio and f"{p.name}_{count + 1}" in names for p in one.parameters):
        count += 1
    return count


def _parts(mode: Int[ndarray, " row"], places: Int[ndarray, "mode parameter"]):
    """Rows of the first two modes together and of each further one, with their parameters' places;
    modes beyond the last are taken for it.
    """
    inside = np.minimum(mode, len(places) - 1)
    yield inside < 2, places[1]
    for number, own in enumerate(places[2:], 2):
        yield inside == number, own


def _rows(rows: Points | Records, mine: Bool[ndarray, " row"]) -> Points | Records:
    """Some of the rows, their modes the first and another."""
    return replace(rows_of(rows, mine), mode=np.minimum(rows.mode[mine], 1))


def _curve(hook, places: Int[ndarray, "mode parameter"]):
    def curve(points: Points, values: ndarray) -> CurveEffect:
        n = points.mode.size
        made = CurveEffect(np.zeros(n), np.zeros(n), *(np.zeros((n, values.size)) for _ in "12"))
        for mine, own in _parts(points.mode, places):
            effect = hook(_rows(points, mine), values[own])
            made.ln_f[mine], made.loss[mine] = effect.ln_f, effect.loss
            made.ln_f_slope[np.ix_(mine, own)] = effect.ln_f_slope
            made.loss_slope[np.ix_(mine, own)] = effect.loss_slope
        return made

    return curve


def _damping(hook, places: Int[ndarray, "mode parameter"]):
    def damping(records: Records, values: ndarray) -> tuple[ndarray, ndarray]:
        change, slope = np.zeros(records.mode.size), np.zeros((records.mode.size, values.size))
        for mine, own in _parts(records.mode, places):
            change[mine], slope[np.ix_(mine, own)] = hook(_rows(records, mine), values[own])
        return change, slope

    return damping
