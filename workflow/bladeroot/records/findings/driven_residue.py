"""Something still drives the mode: its amplitude stops falling well above the noise."""

import numpy as np

from bladeroot.records.finding import Finding
from bladeroot.records.sight import Sight

STATISTIC = "decay rate from a half to 80 % of the fall (of ln A) over that of the last tenth"
THRESHOLD = 3.0


def find(sight: Sight) -> Finding | None:
    """Slopes of ln A; the tail below five times the last amplitude is masked."""
    frames = sight.frames
    level = frames.log.real[: frames.clear]
    if level.size < 80:
        return None
    part = level.size // 10
    tail = slice(level.size - part, level.size)
    x = np.arange(part, dtype=float)
    x -= x.mean()
    slope = float(x @ level[tail]) / float(x @ x)
    error = float(frames.std[tail].mean()) * 2.0 / np.sqrt(float(x @ x))
    fall = level[0] - level
    half, most = (int(np.argmax(fall > share * fall.max())) for share in (0.5, 0.8))
    usual = float(level[most] - level[half]) / max(most - half, 1)
    if usual >= 0.0 or not frames.whole[tail].all():
        return None
    last = float(np.median(level[tail]))
    statistic = usual / min(slope - 3.0 * error, -1e-3 * abs(usual))
    begin = int(np.argmax(level < last + np.log(5.0)))
    start = int(frames.centre[begin])
    text = (
        f"driven residue: from {sight.seconds(frames.centre[tail.start]):.4g} s on the amplitude "
        f"stays at {np.exp(last):.2g} m/s; masked from {sight.seconds(start):.4g} s"
    )
    return Finding(statistic, THRESHOLD, "mask", text, ((start, sight.velocity.size),))
