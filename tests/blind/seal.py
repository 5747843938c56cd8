"""Sealing the answer: a salted hash is shown before the run, the answer itself after it."""

import hashlib
import json
import secrets
from pathlib import Path


def seal(answer: dict, folder: Path) -> str:
    """Write answer and salt where the run does not look; the hash that is shown meanwhile."""
    folder.mkdir(parents=True, exist_ok=True)
    folder.chmod(0o700)
    sealed = {"salt": secrets.token_hex(16), "answer": answer}
    (folder / "answer.json").write_text(json.dumps(sealed))
    return _hash(sealed)


def open_seal(folder: Path, shown: str) -> dict:
    """The answer, if it is the one that was sealed; ValueError if it was changed meanwhile."""
    sealed = json.loads((folder / "answer.json").read_text())
    if _hash(sealed) != shown:
        raise ValueError(f"the sealed answer in {folder} is not the one that was shown as {shown}")
    return sealed["answer"]


def _hash(sealed: dict) -> str:
    text = sealed["salt"] + json.dumps(sealed["answer"], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()
