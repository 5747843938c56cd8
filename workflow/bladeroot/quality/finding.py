"""What a check of a record returns."""

from dataclasses import dataclass

from jaxtyping import Float
from numpy import ndarray

CONSEQUENCES = ("warn", "subtract", "mask", "drop")


@dataclass(frozen=True)
class Finding:
    """A candidate fault of a decay: it counts where `statistic` exceeds `threshold`.

    `spans` are the samples concerned, as pairs of first and one past the last; with consequence
    "mask" they lose their weight. `excess` is what consequence "subtract" takes off the velocity.
    `name` is the finding's id, if not that of its check.
    """

    statistic: float
    threshold: float
    consequence: str
    text: str
    spans: tuple[tuple[int, int], ...] = ()
    excess: Float[ndarray, " sample"] | None = None
    name: str = ""

    @property
    def counts(self) -> bool:
        """Whether the statistic exceeds the threshold."""
        return bool(self.statistic > self.threshold)
