"""The catalogue's sentences for a specimen that has no flanks, no axial force and no simulation."""

import re

_JOINT = (
    (r"\bof the beam and slots\b|\bof beam and slots\b", ""),
    (r"\bon beam and rig\b", "on the specimen"),
    (r"\bthe beam\b|\bthe rig\b", "the specimen"),
    (r"\bthe flanks\b|\ba flank\b|\bflanks\b", "the joint"),
    (r"\bstuck joint\b", "plateau"),
    (r", or says itself that it is not so", ""),
    (r"\bthe shaker's tip\b", "the exciter"),
)
_SIMULATION = (
    (r"(\bwith the amplitude by up to [^;]+) more than simulated\b", r"\1"),
    (r"\bthan simulated\b", "than in a linear mode"),
    (r"\bsimulated as it was\b|\band simulated\b", "and of a linear mode"),
    (r"\bThe simulation explains\b", "Linear modes explain"),
    (r"\bThe simulation misses\b", "Linear modes miss"),
    (r"\bin the simulation\b", "in the model"),
    (r"\bthe simulation as it is\b", "linear modes"),
    (r"\bthe simulation is too (low|high)\b", r"a linear mode is too \1"),
    (r"\bthe simulation without it\b", "linear modes"),
    (r"\bthe simulation explains\b", "linear modes explain"),
    (r"\bthe simulation\b", "a linear mode"),
)


def plainly(text: str, load: str, simulated: bool = False) -> str:
    """A sentence of the catalogue or of a verdict in terms that any specimen has.

    load: its name, or "". simulated: whether anything is, so that sentences may speak of it.
    """
    for pattern, other in _JOINT if simulated else (*_SIMULATION, *_JOINT):
        text = re.sub(pattern, other, text)
    text = text.replace("clamping, gauge and", "clamping, reading and" if load else "clamping and")
    if not load:
        text = re.sub(r" at some of the forces,|\bat each force |, over axial force", "", text)
        text = re.sub(r"\b(over )?(the )?amplitude and (the )?force\b", "over amplitude", text)
        text = text.replace("over over", "over")
    short = load or "preload of the joint"
    text = re.sub(r"\b(an |the |a )?axial forces\b", f"{short}s" if load else "preloads", text)
    text = re.sub(r"\baxial force\b", short, text)
    text = re.sub(r"\bthe force\b", f"the {short}", text)
    text = re.sub(r"\bforces\b", f"{short}s" if load else "preloads", text)
    text = re.sub(r"\bforce\b(?!-)", short, text)
    return re.sub(r"  +", " ", text)


def plainly_but_ids(text: str, load: str, simulated: bool = False) -> str:
    """Plain words, where ids such as force-gain stay."""
    parts = re.split(r"(\b[a-z]+(?:-[a-z]+)+\b)", text)
    return "".join(
        part if k % 2 else plainly(part, load, simulated) for k, part in enumerate(parts)
    )


def length(metres: float) -> str:
    """A length in the unit that needs no exponent: `12 µm`, `2.51 mm`."""
    if metres < 1e-8:
        return f"{1e9 * metres:.3g} nm"
    return f"{1e3 * metres:.3g} mm" if metres >= 1e-3 else f"{1e6 * metres:.3g} µm"
