"""Contact stiffness that depends on whether the force was reached from below or from above."""

from collections.abc import Callable

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter, Records, StickEffect


def law(
    opening: Callable[[np.ndarray], np.ndarray], stiffnesses: tuple[str, ...] = ("ln_kn", "ln_kt")
):
    """The hook by how far both branches are apart over the part of the range of forces.

    They are stiffer by a half of `difference` when unloading, softer when loading.
    """

    def stick(records: Records, values: np.ndarray) -> StickEffect:
        half = -0.5 * records.sign * opening(part(records))
        return StickEffect(
            dict.fromkeys(stiffnesses, values[0] * half),
            dict.fromkeys(stiffnesses, half[:, None]),
        )

    return stick


def part(records: Records) -> np.ndarray:
    """Place of each force between the campaign's least and largest, 0 to 1."""
    low, high = records.force.min(initial=np.inf), records.force.max(initial=0.0)
    return (records.force - low) / (high - low) if high > low else np.full(records.force.size, 0.5)


def constant(part: np.ndarray) -> np.ndarray:
    """The same at all forces."""
    return np.ones(part.size)


def lens(part: np.ndarray) -> np.ndarray:
    """Both turning points remembered: up and down are one state there."""
    return 4.0 * part * (1.0 - part)


def from_the_top(part: np.ndarray) -> np.ndarray:
    """The upper turning point remembered: opens as the force falls from there."""
    return 1.0 - part


MECHANISM = Mechanism(
    id="loading-hysteresis",
    kind="direction",
    sentence="the contact is stiffer when the {force} is reached from above than from below",
    parameters=(
        Parameter(
            "difference", "1", 0.0, 0.3, -0.8, 0.8,
            "of k, where largest: friction keeps a wedged flank in contact as the load falls; "
            "(3.21) averages over it",
        ),
    ),
    splitter="a loading cycle that turns back half-way",
    stick=law(constant),
    over=("sign", "force"),
    form="constant",
).also("kt alone", stick=law(constant, ("ln_kt",)))  # fmt: skip
for _form, _opening in (
    ("closed at both turning points", lens),
    ("closed at the upper turning point", from_the_top),
    ("closed at both, wide at low forces", lambda part: 1.0 - (2.0 * np.sqrt(part) - 1.0) ** 2),
):
    MECHANISM = MECHANISM.also(_form, stick=law(_opening))
