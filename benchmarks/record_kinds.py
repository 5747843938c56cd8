"""Kinds of ring-downs as published data sets hold them: right, told, silent or no curve, each kind.

    python benchmarks/record_kinds.py                # thirty of each kind, about a minute
    python benchmarks/record_kinds.py --seed 7 --count 3 --kinds doublet stop --each

The kinds stand in `published_kinds/`. `br.ringdown` is told the sampling, the quantity, the unit,
the mode to within 1 to 3 % and, of seven records in ten, other modes to 0.5 %.

True is Y'' + w^2 (1 + i eta) Y = 0 for Y = A exp(i phi), of a law from the law itself, of what is
integrated from A and phi of a longer, noiseless motion (of two modes in resonance, of the same
motion, over time). A point is right within WRONG_PPM of the frequency or three stated errors, and
within WRONG_LOSS of the loss factor or three; a curve, if 95 % of its points are. A curve that is
not is told where there is a finding, but for the one that asks for the unit, and silent otherwise.
Record k of kind i is drawn from the seed and 1000 i + k.
"""

import argparse
import secrets
from collections import Counter
from collections.abc import Callable

import bladeroot as br
import numpy as np
from numpy.random import Generator
from published_kinds.kinds import KINDS
from published_kinds.motion import Record

WRONG_PPM = 500.0
WRONG_LOSS = 0.1
IN_SI = {None: 1.0, "g": 9.80665, "mm": 1e-3}
CLASSES = ("right", "told", "silent", "none")


def scored(rng: Generator, kind: Callable[[Generator], Record]) -> tuple[str, float, tuple]:
    """Class of a drawn record, the part of its points that is right, and the findings."""
    record = kind(rng)
    read = record.mode_Hz * (1.0 + rng.choice([-1.0, 1.0]) * rng.uniform(0.01, 0.03))
    named = () if rng.random() < 0.3 else record.others
    others = [f * rng.uniform(0.995, 1.005) for f in named if f < record.rate / 2.2]
    found = br.ringdown(
        record.samples / IN_SI[record.unit], read, sampling_Hz=record.rate,
        quantity=record.quantity, unit=record.unit, other_modes_Hz=others,
    )  # fmt: skip
    curve = found.curves
    if not curve.sizes["point"]:
        return "none", np.nan, (found.verdict,)
    at = curve["amplitude"].values
    if record.over_time:
        at = curve["time"].values + found.free_decay.attrs["start_s"]
    ok = np.ones(at.size, dtype=bool)
    for name, true, least in zip(
        ("frequency", "loss_factor"), record.truth(at), (1e-6 * WRONG_PPM, WRONG_LOSS), strict=True
    ):
        miss = np.abs(curve[name].values - true)
        ok &= (miss <= least * np.abs(true)) | (miss <= 3.0 * curve[f"{name}_std"].values)
    told = tuple(one for one in found.findings if "is the unit right" not in one)
    part = float(np.mean(ok))
    return "right" if part >= 0.95 else "told" if told else "silent", part, told


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    names = [kind.__name__ for kind in KINDS]
    parser.add_argument("--seed", type=int, help="repeat a run; drawn afresh if not given")
    parser.add_argument("--count", type=int, default=30, help="records of each kind, below 1000")
    parser.add_argument("--kinds", nargs="+", choices=names, default=names, metavar="KIND")
    parser.add_argument("--each", action="store_true", help="a line for each record")
    options = parser.parse_args()
    np.seterr(divide="ignore", invalid="ignore")
    seed = secrets.randbits(32) if options.seed is None else options.seed
    total = Counter()
    print(f"seed {seed}, {options.count} records of each kind")
    for number, kind in enumerate(KINDS):
        if kind.__name__ not in options.kinds:
            continue
        count = Counter()
        for k in range(options.count):
            what, part, told = scored(np.random.default_rng([seed, 1000 * number + k]), kind)
            count[what] += 1
            if options.each:
                print(f"  {kind.__name__} {k} {what} {part:.2f} {'; '.join(told)}")
        total += count
        print(f"{kind.__name__:20s}" + "".join(f" {one} {count[one]:3d}" for one in CLASSES))
    print(f"{'all':20s}" + "".join(f" {one} {total[one]:3d}" for one in CLASSES))


if __name__ == "__main__":
    main()
