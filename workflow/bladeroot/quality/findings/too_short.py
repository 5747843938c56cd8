"""Few cycles: frequency and damping cannot be resolved over amplitude."""

from bladeroot.quality.finding import Finding
from bladeroot.quality.sight import Sight

# Whole cycles that curves over amplitude need; a requirement, not a test.
FEWEST = 50
STATISTIC = f"{FEWEST} cycles over the cycles in the decay"
THRESHOLD = 1.0


def find(sight: Sight) -> Finding | None:
    """Cycles in the cut (fewer than eight are refused when it is cut)."""
    cycles = sight.velocity.size / sight.sampling_Hz * sight.own_Hz
    text = f"short: the free decay holds {cycles:.3g} cycles"
    return Finding(FEWEST / cycles, THRESHOLD, "warn", text)
