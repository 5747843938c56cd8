"""What a check of a record returns."""

from dataclasses import dataclass

from jaxtyping import Float
from numpy import ndarray


@dataclass(frozen=True)
class Finding:
    """A candidate fault of a decay: it counts where `statistic` exceeds `threshold`.

    `consequence` is warn, subtract, mask or drop. `spans` are the samples concerned, as pairs of
    first and one past the last, which lose their weight where it masks; `excess` is what it
    subtracts from the velocity. `name` is the finding's id, if not that of its check.
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
