"""Which seeds set thresholds and which score them: kept apart in a file, with the frozen state."""

import secrets
import subprocess
from datetime import UTC, datetime
from pathlib import Path

import yaml
from runs import ROOT

FILE = Path(__file__).parent / "seeds.yaml"
# What decides a verdict; it must be as committed when scoring seeds are drawn.
FROZEN = ("workflow/bladeroot", "workflow/scripts", "config")


def tuning_seed() -> int:
    """Entropy on which thresholds may be set."""
    return int(yaml.safe_load(FILE.read_text(encoding="utf-8"))["tuning"])


def draw_scoring_seed() -> dict:
    """Fresh entropy after the state is frozen: written to the file with commit and date.

    Raises ValueError if what decides a verdict differs from the last commit.
    """
    changed = _git("status", "--porcelain", "--", *FROZEN)
    if changed:
        raise ValueError(f"commit first, thresholds must be frozen; changed:\n{changed}")
    drawn = {
        "frozen": _git("rev-parse", "HEAD"),
        "date": datetime.now(UTC).strftime("%Y-%m-%d"),
        "seed": secrets.randbits(63),
    }
    seeds = yaml.safe_load(FILE.read_text(encoding="utf-8"))
    seeds["scoring"].append(drawn)
    FILE.write_text(HEAD + yaml.safe_dump(seeds, sort_keys=False), encoding="utf-8")
    return drawn


def _git(*arguments: str) -> str:
    done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True)
    return done.stdout.strip()


HEAD = """\
# Seeds of the blind laboratory. `tuning`: thresholds may be set on its cases, and on those of
# `looked_at`. `lap_joint`: first and last seeds of `lap.py` that were scored or looked at, none of
# which scores again. `scoring`: drawn after the commit `frozen`, used once each by
# `matrix.py --score`; nothing is set on them.
"""
