"""The part of the report on the next measurement: what each would decide."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from bladeroot.report.numbers import NONE, fixed, listed, percent
from bladeroot.report.page import Table


def best_option(one: xr.Dataset) -> str:
    """What decides most in an hour, or fixes the cause's size, or kn and kt, best."""
    if one["decided"].values[0] == 0.0 and np.nanmax(one["decided"].values) > 0.0:
        best = int(np.nanargmax(one["decided"].values / one["hours"].values))
    elif np.isfinite(one["size_std"].values).all():
        best = int(np.argmin(one["size_std"].values))
    else:
        best = int(np.argmin(one["expected_ln_std"].sum("stiffness").values))
    return str(one["option"].values[best])


def next_sentence(one: xr.Dataset) -> list[str]:
    """What to measure next, with what it is expected to bring; nothing where that is not known."""
    if "decided" not in one:
        return []
    name = best_option(one)
    if name == str(one["option"].values[0]):
        return []
    here, now = one.sel(option=name), one.isel(option=0)
    text = f"Measure next: {name}"
    if float(here["decided"]) > 0.0:
        text += (
            f", {float(here['hours']):.3g} h; it is expected to decide "
            f"{percent(float(here['decided']), 0)} of the question {_question(one)}"
        )
    elif np.isfinite(float(here["size_std"])):
        text += (
            f"; the cause's size would be known {percent(1 - float(here['size_std']), 0)} better"
        )
    else:
        better = 1.0 - here["expected_ln_std"].values / now["expected_ln_std"].values
        known = zip(here["stiffness"].values, better, strict=True)
        texts = [f"ln {name} {percent(float(part), 0)}" for name, part in known]
        text += f"; better would be known {listed(texts)}"
    return [text + "."]


def _question(one: xr.Dataset) -> str:
    """What the measurement is to decide: between causes, or whether one acts."""
    names = [name.replace("-", " ") for name in str(one["decided"].attrs["rivals"]).split(";")]
    return f"between {listed(names)}" if len(names) > 1 else f"whether {names[0]} acts"


def next_parts(found: Sequence[xr.Dataset]) -> list[Table]:
    """A table of the measurements that were weighed."""
    every = [tuple(one["stiffness"].values.astype(str)) for one in found if "decided" in one]
    names = every[0] if len(set(every)) == 1 else ()
    rows = [
        (
            one.attrs["structure"],
            str(name),
            fixed(float(here["hours"]), 1),
            percent(float(here["decided"]), 0),
            percent(1.0 - float(here["size_std"]), 0),
            *(fixed(float(v), 2) for v in here["expected_ln_std"] if names),
        )
        for one in found
        if "decided" in one
        for name in one["option"].values
        for here in [one.sel(option=name)]
    ]
    if all(set(row[3:]) <= {NONE, percent(0.0, 0)} for row in rows):
        return []  # none brings anything
    sets = [
        f"{one.attrs['structure']}: {_question(one)}"
        for one in found
        if "decided" in one and ";" in one["decided"].attrs["rivals"]
    ]
    return [
        Table(
            "What a further measurement is expected to bring. Question decided: how much of the "
            "doubt between the possible causes it removes on average, the best for its hours "
            f"first{' (' + '; '.join(sets) + ')' if sets else ''}. Size: how "
            "much better the first cause's size would be known"
            f"{'. std: of ln k at the reference load' if names else ''}",
            ("judged", "measurement", "hours", "question decided", "size better by",
             *(f"std ln {name}" for name in names)),
            rows,
        )
    ]  # fmt: skip
