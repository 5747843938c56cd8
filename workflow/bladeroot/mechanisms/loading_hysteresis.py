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


WIDTH = Parameter(
    "width", "1", 0.2, 0.7, 0.01, 2.0, "part of the range of forces, from the turning point on",
    log=True,
)  # fmt: skip


def turned_over(records: Records, width: float) -> tuple[np.ndarray, np.ndarray]:
    """How much of the other branch is reached below the upper turning point, as by Dahl's friction;
    its derivative by `width`. Nothing when loading.
    """
    down, way = records.sign < 0, 1.0 - part(records)
    left = np.exp(-way / width)
    return np.where(down, 1.0 - left, 0.0), np.where(down, -left * way / width**2, 0.0)


def from_the_top(records: Records, values: np.ndarray) -> StickEffect:
    """The upper turning point remembered: the branches part as the force falls from there."""
    reached, by_width = turned_over(records, values[1])
    slope = np.column_stack([reached, values[0] * by_width])
    both = ("ln_kn", "ln_kt")
    return StickEffect(dict.fromkeys(both, values[0] * reached), dict.fromkeys(both, slope))


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
    ("closed at both, wide at low forces", lambda part: 1.0 - (2.0 * np.sqrt(part) - 1.0) ** 2),
):
    MECHANISM = MECHANISM.also(_form, stick=law(_opening))
MECHANISM = MECHANISM.also("closed at the upper turning point", WIDTH, stick=from_the_top)
