"""Tables of the diagnosis: structures, candidates, sizes of the causes, gain, kn and kt."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from bladeroot.report.numbers import NONE, fixed, interval, listed, percent, significant
from bladeroot.report.page import Table
from bladeroot.report.verdict import answer_of, between_forces, causes_of, plain, size
from bladeroot.report.words import Words, words_of

# as `bladeroot.diagnosis.verdict` says it
CHANNELS = {
    "stick": "stick frequencies",
    "damping": "loss factors of the stuck joint",
    "curve": "curves over amplitude",
    "record": "findings in the records",
}
NOT_THOUGH_AHEAD = "beyond its limits, by its error, or less beside the other causes"


def structures_table(verdicts: Sequence[Mapping]) -> Table:
    """The verdicts side by side."""
    rows = []
    for said in verdicts:
        gain = between_forces(said)
        sides = [percent(gain.get(side, np.nan), 2) for side in ("before", "after")]
        causes = causes_of(said)
        rows.append(
            (
                said["structure"],
                answer_of(said),
                listed([plain(c["mechanism"]) for c in causes]) or NONE,
                size(causes[0]["parameters"][0]) if causes else NONE,
                " → ".join(dict.fromkeys(sides)),
            )
        )
    return Table(
        "The same question asked with each structure: a name is safe where the geometries agree, a "
        "size only within their spread",
        ("structure", "answer", "cause", "size", "error at unseen forces"),
        rows,
    )


def _why_not(one: xr.Dataset) -> list[str]:
    """Why each candidate is not named: it cannot be, or not though it shows more than the cause."""
    channels, evidence = one["channel"].values, one["log_evidence"].values
    mechanism = ~np.isin(one["class"].values, ["smooth", "record"])
    named = (one["is_named"].values == 1) & mechanism
    texts = []
    for k, barred in enumerate(one["barred"].values.astype(str)):
        causes = evidence[named & (channels == channels[k])]
        ahead = mechanism[k] and not named[k] and causes.size and evidence[k] > causes.max()
        texts.append(barred or (NOT_THOUGH_AHEAD if ahead else NONE))
    return texts


def candidates_table(found: Sequence[xr.Dataset]) -> Table:
    """Everything that was compared."""
    rows = [
        (
            one.attrs["structure"],
            str(name) if kind == "smooth" else plain(str(name)),
            str(kind),
            CHANNELS.get(str(channel), str(channel)),
            fixed(float(value), 1),
            why_not,
        )
        for one in found
        for name, kind, channel, value, why_not in zip(
            *(one[key].values for key in ("candidate", "class", "channel", "log_evidence")),
            _why_not(one),
            strict=True,
        )
        if kind != "record" or value > 0.0
    ]
    return Table(
        "All that was tried, by its evidence: how much more probable it makes the records than "
        "they are without a cause (natural logarithm; 3 is 20 to 1; of a fault of records, -ln of "
        "the chance of as many by mistake). Smooth: a curve of any shape, which names nothing",
        ("judged", "possible cause", "class", "data", "log evidence", "not named because"),
        rows,
    )


def sizes_table(verdicts: Sequence[Mapping]) -> Table:
    """All parameters of all causes."""
    rows = [
        (
            said["structure"],
            plain(cause["mechanism"]),
            plain(p["name"]),
            size(p),
            "yes" if cause["plausible"] else "no",
            cause["splitter"],
        )
        for said in verdicts
        for cause in said["causes"]
        for p in cause["parameters"]
    ]
    return Table(
        "The causes with their parameters",
        ("judged", "cause", "parameter", "value", "plausible", "what would tell it from others"),
        rows,
        folded=True,
    )


def gain_table(verdicts: Sequence[Mapping], words: Words) -> Table:
    """Held-out errors before and after."""
    rows, load = [], words.short or "condition"

    def add(structure: str, text: str, sides: Mapping) -> None:
        before, after = sides["before"], sides["after"]
        rows.append((structure, text, percent(before, 3), percent(after, 3),
                     percent(1.0 - after / before, 0)))  # fmt: skip

    for said in verdicts:
        for key, sides in said["gain"].items():
            whose, between, parts = key.partition("between_")
            if between and parts != "amplitudes":
                what = "loss factor of the stuck joint (relative)" if whose else "stick frequency"
                left, _, bias = parts.replace("forces", f"{load}s").partition("_without_")
                text = f"{left.replace('hold', 'clamping').replace('_', ' ')} left out"
                text += ", without the model's bias" if bias else ""
                add(said["structure"], f"{what}, {text}", sides)
                for mode, part in sides.get("by_mode", {}).items():
                    add(said["structure"], f"{what} of {mode}, {text}", part)
        for key, left in (("within_records", f"a {load}"), ("between_amplitudes", "amplitudes")):
            for name, sides in said["gain"].get(key, {}).items():
                text = "frequency" if name == "frequency" else "loss factor (absolute)"
                add(said["structure"], f"{text} over amplitude, {left} left out", sides)
        for key, text in (("log_score", "stick frequency"), ("log_score_curves", "curves")):
            if key in said["gain"]:
                before, after = said["gain"][key]["before"], said["gain"][key]["after"]
                name = f"{text}: log score of what was left out (more is better)"
                cells = fixed(before, 1), fixed(after, 1), f"{after - before:+z.1f}"
                rows.append((said["structure"], name, *cells))
    return Table(
        "What the cause gains: errors (root mean square) of predictions of data that the fit "
        "did not see, before and after. The model's bias is a constant error of each mode that the "
        "fit learns and a prediction is spared; without it the error is that of the simulation",
        ("judged", "prediction of", "before", "after", "smaller by"),
        rows,
    )


def stiffness_tables(found: Sequence[xr.Dataset]) -> list[Table]:
    """kn and kt at the ends of the campaign's forces and at 12 kN."""
    full = [one for one in found if "law_k" in one]
    several = [one for one in full if "interface_k" in one]
    if several:
        return [_interfaces(one) for one in several]
    if not full:
        return []
    rows = []
    for one in full:
        forces = one["law_force"].values
        near = int(np.argmin(np.abs(forces - 12e3)))
        for f in sorted({0, near, forces.size - 1}):
            here = one.isel(law_force=f)
            cells = [one.attrs["structure"], f"{forces[f] / 1e3:.3g}"]
            cells += [
                _k(here, name, stage) for name in ("kn", "kt") for stage in ("before", "after")
            ]
            cells += [fixed(float(c), 2) for c in here["law_correlation"]]
            rows.append(tuple(cells))
    return [
        Table(
            "kn and kt of a flank by the laws before and after, GN/m, with one standard deviation "
            "of ln k, and the correlation of ln kn and ln kt",
            ("structure", "force / kN", "kn before", "kn after", "kt before", "kt after",
             "correlation before", "correlation after"),
            rows,
        )
    ]  # fmt: skip


def _interfaces(one: xr.Dataset) -> Table:
    """Contact stiffness of each interface with its intervals."""
    rows = []
    for called in one["stiffness"].values.astype(str):
        here = one.sel(stiffness=called)
        (middle, inner), (_, outer) = (interval(here["interface_k"], q) for q in (0.16, 0.025))
        std = float(np.sqrt(here["interface_ln_covariance"].sel(stiffness_=called)))
        known = fixed(std / float(here["interface_prior_std"]), 2)
        rows.append((called, middle, inner, outer, known))
    words, at = words_of(one), float(one["interface_load"])
    where = ""
    if words.load:
        middle = f"{significant(words.factor * at, 3)} {words.unit}"
        where = f" at a {words.short} of {middle} (geometric mean of the records')"
    return Table(
        f"Contact stiffness of each interface{where}, GN/m, named causes included: "
        "median, 68 and 95 % intervals, and the standard deviation of ln k over that of the "
        "structure file's range (1: the frequencies say nothing)",
        ("stiffness", "median", "68 %", "95 %", "of the range"),
        rows,
    )


def _k(here: xr.Dataset, name: str, stage: str) -> str:
    """Stiffness with its interval; nothing after a verdict without a cause."""
    if stage == "after" and not here.attrs["named"]:
        return NONE
    one = here.sel(stage=stage, stiffness=name)
    k, spread = 1e-9 * float(one["law_k"]), float(np.exp(one["law_ln_std"]))
    return f"{significant(k, 2)} ({significant(k / spread, 2)} to {significant(k * spread, 2)})"
