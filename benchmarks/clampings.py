"""Do intervals of a level's mean hold the truth where clampings are kept over loads, or are not.

    python benchmarks/clampings.py [campaigns]

Campaigns of 2 to 5 clampings, each named at 3 to 8 loads with one or two records. What a clamping
keeps over its loads, what it has anew at each, and what its records differ, are drawn normal, with
the sizes of the row.
"""

import sys

import numpy as np
from bladeroot.pooling.components import pool

SHAPES = ((5, 3, 1), (3, 4, 2), (4, 6, 2), (2, 8, 2))  # clampings, loads, records of each
SIZES = ((1.0, 0.0, 0.2), (1.0, 0.3, 0.2), (0.5, 1.0, 0.2), (0.0, 1.0, 0.2))
OWN_ERROR = 0.01


def ratios(rng: np.random.Generator, shape: tuple, sizes: tuple) -> np.ndarray:
    """Errors of one campaign's means over their stated ones; the truth is zero."""
    clampings = shape[0]
    kept, anew, between = sizes
    y = kept * rng.standard_normal((clampings, 1, 1)) + np.zeros(shape)
    y += anew * rng.standard_normal(shape[:2])[:, :, None]
    y += np.hypot(between, OWN_ERROR) * rng.standard_normal(shape)
    clamping, load, _ = (own.ravel() for own in np.indices(shape))
    found = pool(y.ravel(), np.full(y.size, OWN_ERROR), load, clamping, np.zeros(y.size))
    return np.abs(found.mean / found.std)


def main() -> None:
    campaigns = int(sys.argv[1]) if len(sys.argv) > 1 else 150
    print("clampings, loads, records | kept, anew, between records | 95 % hold | one error holds")
    for shape in SHAPES:
        for sizes in SIZES:
            rng = np.random.default_rng([*shape, int(10 * sum(sizes))])
            z = np.concatenate([ratios(rng, shape, sizes) for _ in range(campaigns)])
            shares = f"{100 * np.mean(z < 1.96):.1f} % | {100 * np.mean(z < 1.0):.1f} %"
            print(*shape, "|", *sizes, "|", shares, flush=True)


if __name__ == "__main__":
    main()
