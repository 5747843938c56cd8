"""One recording to the decay, the curves and the plateau of a mode, as a person overrules it."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import xarray as xr

from bladeroot.decay.cut import LEAST_FALL
from bladeroot.decay.free_decay import free_decay
from bladeroot.decay.freevib import freevib, no_decay, surely_known
from bladeroot.decay.overrides import banded, kept, within
from bladeroot.plateau.plateau import record_plateau
from bladeroot.signal.lines import FAR_FROM_EXPECTED
from bladeroot.signal.recording import Recording

# What the sheet says of a record, for all who read its artifacts; what it does not is left out.
FACTS = ("record", "mode", "expected_Hz", "load", "load_name", "load_unit", "force_N", "hold",
         "direction", "event", "group", "sensor", "band_Hz")  # fmt: skip

# Half-widths, over the mode's frequency, of the band that is kept of a record with more lines than
# are followed, whose curve falls by less than a decay does, or is none.
WIDTHS = (0.35, 0.05)
CROWDED = (
    "more lines ring in this record than can be followed, and hide the mode: nothing but {:.5g} to "
    "{:.5g} Hz of it is looked at"
)


def analyse(
    recording: Recording, known: Mapping, cutting: Mapping, estimation: Mapping
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    """Free decay, curves over amplitude and plateau of one mode of a recording in SI units.

    Args:
        recording: what was recorded.
        known: what the sheet says of it: FACTS; `other_modes_Hz`, the expected frequencies of the
            campaign's other modes; `simulated`; and what a person overrules (`start_s`, `end_s`,
            `keep`, `band_Hz`; in words: `overruled`).
        cutting: section `record` of the configuration, as of `bladeroot.decay.cut.cut`.
        estimation: section `decay`, as of `bladeroot.decay.record.estimate`.

    A record that cannot be used comes back without points, rejected with a reason.
    """
    made = _looked_at(recording, known, cutting, estimation)
    if not made[0].attrs.get("crowded"):
        return made
    expected_Hz, stated = float(known["expected_Hz"]), known.get("band_Hz")
    around = [((1.0 - width) * expected_Hz, (1.0 + width) * expected_Hz) for width in WIDTHS]
    for band_Hz in around if stated is None else [stated]:
        if _fall(made) > LEAST_FALL:
            break
        try:
            again = _looked_at(recording, known, cutting, estimation, band_Hz)
        except ValueError:  # the decay is too short for the filter
            continue
        made = max(made, again, key=_fall)
    return made


def _fall(made: tuple[xr.Dataset, xr.Dataset, xr.Dataset]) -> float:
    """Factor by which the amplitude of a record's curves falls; 0 without any."""
    amplitude = made[1]["amplitude"].values
    return float(amplitude.max() / amplitude.min()) if amplitude.size else 0.0


def _looked_at(
    recording: Recording,
    known: Mapping,
    cutting: Mapping,
    estimation: Mapping,
    band_Hz: tuple[float, float] | None = None,
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    """Free decay, curves and plateau of the record as it is, or of nothing but a band of it."""
    remarks = override_remark(known)
    if band_Hz is not None:
        remarks += (("crowded", CROWDED.format(*band_Hz)),)
    decay = free_decay(
        recording,
        float(known["expected_Hz"]),
        tuple(known["other_modes_Hz"]),
        **cutting,
        start_s=known.get("start_s"),
        end_s=known.get("end_s"),
        remarks=remarks,
        band_Hz=band_Hz,
    )
    return estimated(decay.assign_attrs(quantity=recording.quantity), known, estimation)


def override_remark(known: Mapping) -> tuple[tuple[str, str], ...]:
    """What a person overrules as a finding, so that every table shows it."""
    text = known.get("overruled")
    return (("override", f"overruled: {text}"),) if text else ()


def estimated(
    decay: xr.Dataset, known: Mapping, estimation: Mapping
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    """A judged free decay with what is known of it, its curves and its plateau."""
    decay = kept(decay) if known.get("keep") else decay
    decay.attrs |= {name: known[name] for name in FACTS if known.get(name) is not None}
    decay.attrs["expected_Hz"] = float(known["expected_Hz"])  # a sheet may say 540
    decay.attrs["simulated"] = int(known["simulated"])
    modes_Hz = tuple(known["other_modes_Hz"])
    made = estimate(decay, **estimation, band_Hz=known.get("band_Hz"), modes_Hz=modes_Hz)
    return decay, surely_known(made), record_plateau(made)


def estimate(
    cut: xr.Dataset,
    damping: str = "hysteretic",
    band_Hz: Sequence[float] | None = None,
    estimator: Callable[..., xr.Dataset] = freevib,
    modes_Hz: tuple[float, ...] = (),
) -> xr.Dataset:
    """Curves of a record over amplitude.

    A rejected record has no points; one that cannot be estimated, or in which another mode than
    the one that is meant was followed, is rejected.

    Args:
        cut: free decay as from `decay.free_decay`, with `expected_Hz` in its attributes.
        damping: law of damping, "hysteretic" or "viscous".
        band_Hz: a person's band, outside which nothing counts, the mode itself included.
        estimator: `freevib`, or another with its arguments.
        modes_Hz: expected frequencies of other modes.

    Returns:
        Variables of `freevib`; attributes of `cut`.
    """
    if band_Hz is not None:
        cut = banded(cut, band_Hz)
    facts, made = cut.attrs | {"damping": damping}, None
    if facts["verdict"] == "usable":
        # a start that is masked is no part of the decay
        first = int(np.argmax(cut["usable"].values))
        begin_s = first / facts["sampling_Hz"]
        velocity = cut["velocity"].values[first:].astype(float)
        said = [facts[name] for name in ("sampling_Hz", "expected_Hz", "noise_velocity")]
        options = {"damping": damping, "usable": cut["usable"].values[first:].astype(bool)}
        if estimator is freevib:
            options["filtered"] = band_Hz is not None
            if "widening" in cut:
                time = cut["widening_time"].values - begin_s
                options["taken"] = (time, cut["widening"].values, cut["doubt"].values)
        try:
            made = later(estimator(velocity, *said, **options), begin_s)
            made = made if band_Hz is None else within(made, band_Hz)
            _refuse_another(made, facts["expected_Hz"], modes_Hz)
        except ValueError as error:
            made, facts = None, facts | {"verdict": "rejected", "reason": str(error)}
        else:
            if "taken" in options:
                made.attrs["other_modes_Hz"] = np.atleast_1d(facts["components_Hz"]).tolist()
    made = no_decay() if made is None else made
    return made.assign_attrs(facts, estimator=estimator.__name__)


def _refuse_another(made: xr.Dataset, expected_Hz: float, modes_Hz: tuple[float, ...]) -> None:
    """ValueError where the curves lie far off, and nearer to another known mode.

    Where the mode is weak, as near its node, another one may be followed.
    """
    own_Hz = float(np.median(made["frequency"].values))
    off = abs(own_Hz - expected_Hz)
    nearest = min((abs(own_Hz - one) for one in modes_Hz), default=np.inf)
    if off > FAR_FROM_EXPECTED * expected_Hz and nearest < off:
        raise ValueError(
            f"the mode that was followed lies at {own_Hz:.6g} Hz, nearer to another known one than "
            f"to the one that is asked for, at {expected_Hz:.6g} Hz"
        )


def later(made: xr.Dataset, seconds: float) -> xr.Dataset:
    """Curves whose times count from the start of the cut, which lies some seconds before theirs."""
    if not seconds:
        return made
    times = [name for name in ("time", "block_time") if name in made]
    moved = {name: (made[name] + seconds).assign_attrs(made[name].attrs) for name in times}
    return made.assign(moved)
