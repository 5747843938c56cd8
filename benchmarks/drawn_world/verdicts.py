"""Curves beside the truth: what class a record falls into, and how large its errors are.

wrong: some point lies outside both the tolerance (500 ppm in frequency, 10 % in loss factor) and
three of its stated errors, in the same quantity. wrong in silence: that, and the record has no
finding and its two estimators agree. A dropped record is judged by the curve that it has without
the checks: dropped though right, dropped and wrong, or dropped without a curve.

Where errors are stated rightly, one of a hundred points passes three of them all the same where
they exceed the tolerance. `class, as a curve` therefore puts the limit where the largest of all
points of a curve passes it as seldom as one point passes three: it is the class to aim at. `class,
as read` does so only for points whose stated error at 95 % exceeds the tolerance: who reads them
has been told that they are not known so well, and is misled where that error does not hold.
"""

import numpy as np
from scipy.stats import norm

from .circumstances import circumstances

TOLERANCE = {"frequency": 5e-4, "loss_factor": 0.1}
STATED, READ = 3.0, 1.96  # standard errors: beyond the first is wrong, the second is read
NOT_OF_THE_CURVE = {"reader"}  # findings that speak of the file alone
END = 0.1  # of the range of ln A: start and end of a curve
COUNTS = ("class", "class, as read", "class, as a curve")
CLASSES = (
    "right", "wrong, told", "wrong in silence", "dropped though right", "dropped, wrong",
    "dropped, no curve", "crash",
)  # fmt: skip


def errors(event, mode: int, sensor: int, curves: dict) -> dict[str, np.ndarray]:
    """For both quantities: error, error relative to the truth, and over the stated one."""
    true = dict(zip(TOLERANCE, event.truth(mode, sensor, curves["amplitude"]), strict=True))
    found = {}
    for name, value in true.items():
        error = curves[name] - value
        found[name] = error
        found[f"{name} relative"] = error / value
        found[f"{name} stated"] = error / curves[f"{name}_std"]
        found[f"{name} read"] = READ * curves[f"{name}_std"] / value
    return found


def wrong_points(
    found: dict[str, np.ndarray], stated: float = STATED, vague: float | None = None
) -> np.ndarray:
    """Points outside both the tolerance and so many stated errors.

    vague: as many for points that are said to be known worse than the tolerance.
    """
    bad = []
    for name, most in TOLERANCE.items():
        limit = stated if vague is None else np.where(found[f"{name} read"] > most, vague, stated)
        off, within = (np.abs(found[f"{name} {what}"]) for what in ("relative", "stated"))
        bad.append(~(off <= most) & ~(within <= limit))
    return bad[0] | bad[1]


def largest_of(count: int) -> float:
    """Limit that the largest of so many passes as seldom as one normal error passes STATED."""
    return float(norm.isf(norm.sf(STATED) / count))


def regions(amplitude) -> dict[str, np.ndarray]:
    """Start, middle and end by the range of ln A."""
    log = np.log(amplitude)
    part = (log.max() - log) / max(log.max() - log.min(), 1e-12)
    return {"start": part < END, "middle": (part >= END) & (part <= 1 - END), "end": part > 1 - END}


def verdict(answer, wrong: bool | None) -> str:
    """One of CLASSES; `wrong` is of the curves given or, of a dropped record, without checks."""
    if answer.crash:
        return "crash"
    if not answer.curves:
        if wrong is None:
            return "dropped, no curve"
        return "dropped, wrong" if wrong else "dropped though right"
    if not wrong:
        return "right"
    told = set(answer.findings) - NOT_OF_THE_CURVE
    return "wrong, told" if told else "wrong in silence"


def score(event, mode: int, sensor: int, answer, unchecked: dict, bound) -> dict:
    """All that is counted of one record; numbers only, for JSON."""
    curves = answer.curves or unchecked
    row = {
        "seed": event.seed, "mode": mode + 1, "sensor": sensor + 1, "findings": answer.findings,
        "cpu_s": answer.cpu_s, "samples": int(event.sensors[sensor].samples.size),
        "features": circumstances(event, mode, sensor), "told": answer.told, "crash": answer.crash,
    }  # fmt: skip
    if not curves:
        return row | dict.fromkeys(COUNTS, verdict(answer, None))
    found = errors(event, mode, sensor, curves)
    bad = wrong_points(found)
    most = largest_of(2 * bad.size)
    counted = bad, wrong_points(found, STATED, most), wrong_points(found, most)
    row |= {
        name: verdict(answer, bool(one.any())) for name, one in zip(COUNTS, counted, strict=True)
    }
    row["points"] = int(bad.size)
    row["wrong share"] = float(bad.mean())
    parts = regions(curves["amplitude"])
    row["wrong where"] = [name for name, inside in parts.items() if bad[inside].any()]
    for name in TOLERANCE:
        z, relative = np.abs(found[f"{name} stated"]), np.abs(found[f"{name} relative"])
        row[name] = {
            "within 3": float(np.mean(z <= STATED)),
            "median relative": float(np.median(relative)),
            "worst relative": float(np.max(relative)),
            "worst stated": float(np.max(z)),
            "chi": {
                part: float(np.sqrt(np.mean(z[inside] ** 2)))
                for part, inside in parts.items()
                if inside.any()
            },
        }
    if bound is not None:
        for name, least in zip(TOLERANCE, bound(curves["amplitude"]), strict=True):
            good = np.isfinite(least) & (least > 0)
            if good.any():
                ratio = np.abs(found[name][good]) / least[good]
                row[name]["over bound"] = float(np.median(ratio) / 0.6745)
    return row
