"""Faults of the records: which kind is more frequent than false alarms explain."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Bool
from numpy import ndarray
from scipy.special import gammaln

from bladeroot.diagnosis.guards import CERTAIN, PRIOR
from bladeroot.mechanisms.mechanism import Mechanism

_MOST = 50.0  # nats


@dataclass(frozen=True)
class Faulty:
    """A record mechanism, the records that show it, and the log odds that there is such a fault."""

    mechanism: Mechanism
    records: Bool[ndarray, " record"]
    log_odds: float

    @property
    def probability(self) -> float:
        """That there is such a fault."""
        return float(1.0 / (1.0 + np.exp(-self.log_odds)))

    @property
    def named(self) -> bool:
        """Whether false alarms do not explain the findings."""
        return self.probability >= CERTAIN


def faulty_records(seen: xr.Dataset, candidates: Sequence[Mechanism]) -> list[Faulty]:
    """Every record mechanism of the catalogue, by the findings of the records.

    Any share of the records, all as likely, stands against the rate of false alarms that the
    mechanism's prior states.
    """
    found = []
    for one in candidates:
        if one.channel != "record":
            continue
        shown = showing(seen, one.finding)
        count, total = int(shown.sum()), shown.size
        odds = -_MOST
        if count:
            rate = one.parameters[0].mean
            ways = gammaln(total + 1) - gammaln(count + 1) - gammaln(total - count + 1)
            alarms = ways + count * np.log(rate) + (total - count) * np.log1p(-rate)
            odds = float(np.clip(-np.log(total + 1.0) - alarms - PRIOR, -_MOST, _MOST))
        found.append(Faulty(one, shown, odds))
    return found


def showing(seen: xr.Dataset, findings: str) -> Bool[ndarray, " record"]:
    """The records with any of some findings, whose ids are joined by semicolons."""
    ids = set(findings.split(";")) - {""}
    return np.array(
        [not ids.isdisjoint(text.split(";")) for text in seen["findings"].values.astype(str)], bool
    )
