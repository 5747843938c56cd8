"""Faults of the records: which kind is more frequent than false alarms explain."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Bool
from numpy import ndarray
from scipy.special import gammaln

from bladeroot.diagnosis.guards import FALSE_ALARM, PRIOR
from bladeroot.mechanisms.mechanism import Mechanism


@dataclass(frozen=True)
class Faulty:
    """A record mechanism, the records that show it, and ln of the chance of as many by mistake."""

    mechanism: Mechanism
    records: Bool[ndarray, " record"]
    ln_chance: float

    @property
    def named(self) -> bool:
        """Whether false alarms do not explain them."""
        return bool(self.ln_chance < np.log(FALSE_ALARM))

    @property
    def probability(self) -> float:
        """That there is such a fault: any share of the records against false alarms alone."""
        count, total = int(self.records.sum()), self.records.size
        if not count:
            return 0.0
        rate = self.mechanism.parameters[0].mean
        ways = gammaln(total + 1) - gammaln(count + 1) - gammaln(total - count + 1)
        alarms = ways + count * np.log(rate) + (total - count) * np.log1p(-rate)
        odds = -np.log(total + 1.0) - alarms - PRIOR
        return float(1.0 / (1.0 + np.exp(-np.clip(odds, -50.0, 50.0))))


def faulty_records(seen: xr.Dataset, candidates: Sequence[Mechanism]) -> list[Faulty]:
    """Every record mechanism of the catalogue, by the findings of the records.

    The chance is binomial's upper tail with the false alarms that the mechanism's prior states.
    """
    findings = [set(text.split(";")) for text in seen["findings"].values.astype(str)]
    found = []
    for one in candidates:
        if one.channel != "record":
            continue
        ids = set(one.finding.split(";"))
        shown = np.array([bool(ids & own) for own in findings], dtype=bool)
        chance = _tail(int(shown.sum()), shown.size, one.parameters[0].mean)
        found.append(Faulty(one, shown, chance))
    return found


def _tail(count: int, total: int, rate: float) -> float:
    """ln of the probability of `count` or more of `total`."""
    if not count:
        return 0.0
    k = np.arange(count, total + 1)
    ways = gammaln(total + 1) - gammaln(k + 1) - gammaln(total - k + 1)
    return float(np.logaddexp.reduce(ways + k * np.log(rate) + (total - k) * np.log1p(-rate)))
