"""First cycles of a record that decay unlike all others at the same amplitude.

A release may leave something behind that dies within some cycles. One record by itself cannot tell
that from slip which just begins; records that pass the same amplitude later in their decay can.
"""

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray
from scipy.special import stdtrit

# Records that pass an amplitude at least this far below their start (in ln A) are settled there.
SETTLED = 0.1
# So many of them are asked, and a record must lie outside what they predict with this probability.
ASKED = 4
PREDICTED = 0.999
# A record that differs further down than this (in ln A) is another decay, not an unsettled one.
DEEPEST = 0.3


def unsettled(
    ladder: Float[ndarray, " amplitude"],
    start: Float[ndarray, " record"],
    value: Float[ndarray, "record amplitude"],
    std: Float[ndarray, "record amplitude"],
) -> Bool[ndarray, "record amplitude"]:
    """Points of a record, from its start down, outside the prediction interval of settled records.

    ladder: amplitudes (m), rising. start: amplitude at which each record begins. value, std: a
    quantity with its standard error, NaN where not reached. The interval is that of one more draw
    from the settled records' distribution (Student), widened by the record's own error. Where
    fewer than ASKED settled records pass, or the difference goes on for more than DEEPEST, nothing
    is doubted.
    """
    depth = np.log(start)[:, None] - np.log(ladder)
    asked = np.isfinite(value) & (depth >= SETTLED)
    out = np.zeros(value.shape, dtype=bool)
    for record in range(len(start)):
        first = None
        for k in np.flatnonzero(np.isfinite(value[record]))[::-1]:
            others = asked[:, k].copy()
            others[record] = False
            count = int(others.sum())
            if count < ASKED:
                continue
            first = depth[record, k] if first is None else first
            settled = value[others, k]
            spread = settled.std(ddof=1) * np.sqrt(1.0 + 1.0 / count)
            reach = stdtrit(count - 1, 0.5 + 0.5 * PREDICTED) * np.hypot(spread, std[record, k])
            if abs(value[record, k] - settled.mean()) <= reach:
                break
            if depth[record, k] > max(DEEPEST, first):
                out[record] = False
                break
            out[record, k] = True
    return out
