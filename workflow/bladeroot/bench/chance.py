"""Random numbers that belong to a name: a new record or hold never changes those of the others."""

import hashlib

import numpy as np


def generator(seed: int, *names: str) -> np.random.Generator:
    """Random generator of the bench's seed and a chain of names, the same on every machine.

    Python's own `hash` differs between processes, so the names pass through SHA-256.
    """
    digest = hashlib.sha256("\0".join(names).encode()).digest()
    words = [int.from_bytes(digest[i : i + 4], "little") for i in range(0, 16, 4)]
    return np.random.default_rng(np.random.SeedSequence([seed, *words]))
