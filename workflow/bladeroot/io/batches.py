"""Records that one process works through together: large enough to pay for its start, and stable.

To start Python and load the compiled code costs as much as some twenty records. A batch must not
change when another one does: a name's hash, and not its place in the sheet, says where it belongs.
"""

import hashlib
from collections.abc import Iterable


def batches(names: Iterable[str], most: int) -> dict[str, tuple[str, ...]]:
    """Split names into batches of at most `most`, by the leading bits of their hashes.

    Returns the names of each batch, sorted, by the batch's own name, `b` and its bits. A batch that
    grows beyond `most` is halved by its next bit and no other changes: the leaves of a binary trie.

    Raises:
        ValueError: a name stands twice, or `most` is below 1.
    """
    if most < 1:
        raise ValueError(f"a batch must hold at least one record, got {most}")
    ordered = sorted(names)
    bits = {name: _bits(name) for name in ordered}
    if len(bits) < len(ordered):
        raise ValueError("the names of records must differ")
    return _leaves(bits, "", most)


def _bits(name: str) -> str:
    return f"{int.from_bytes(hashlib.sha256(name.encode()).digest()):0256b}"


def _leaves(bits: dict[str, str], prefix: str, most: int) -> dict[str, tuple[str, ...]]:
    here = tuple(name for name, own in bits.items() if own.startswith(prefix))
    if len(here) <= most:
        return {f"b{prefix}": here} if here else {}
    within = {name: bits[name] for name in here}
    return _leaves(within, prefix + "0", most) | _leaves(within, prefix + "1", most)
