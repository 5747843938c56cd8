"""What a seed hides, and with which simulation, in the proportions of the first list of campaigns.

Numbers are weights.
"""

import numpy as np

KINDS = {"null": 14, "single": 27, "pair": 11, "outside": 10}
MODELS = {"assembly": 30, "table": 27}
SINGLES = {
    "slip": 4, "contact-law": 5, "gain": 2, "zero": 2, "lagging-load": 1, "relaxation": 1,
    "seating": 1, "temperature": 1, "drift": 1, "ageing": 1, "tip-mass": 1, "crack": 1,
    "hardening": 1, "drag": 1, "clipping": 1, "hum": 1, "touch": 1, "normal-load": 1,
}  # fmt: skip
PAIRS = {
    "slip": 6, "contact-law": 3, "drag": 2, "gain": 1, "zero": 1, "lagging-load": 1,
    "relaxation": 1, "seating": 1, "temperature": 1, "drift": 1, "ageing": 1, "crack": 1,
    "hardening": 1, "clipping": 1,
}  # fmt: skip
OUTSIDE = {
    "rattle": 2, "rubber": 2, "operator": 2, "humidity": 1, "cable": 1, "magnet": 1, "breathing": 1,
}  # fmt: skip
ALIKE = ({"contact-law", "seating"}, {"temperature", "drift"})  # never a pair
# What can be seen without a simulation, and how often there is none then.
WITHOUT_SIMULATION, SHARE_WITHOUT = {"slip", "contact-law", "rubber"}, 0.15


def choice(rng: np.random.Generator, weights: dict[str, int]) -> str:
    """A key, as often as its weight says."""
    share = np.array(list(weights.values()), float)
    return str(rng.choice(list(weights), p=share / share.sum()))


def drawn(rng: np.random.Generator, kind: str = "", effect: str = "") -> tuple[str, str, list[str]]:
    """Kind, simulation (`assembly`, `table` or `none`) and ids of what is hidden."""
    if effect:
        kind = "outside" if effect in OUTSIDE else "single"
    kind = kind or choice(rng, KINDS)
    effects = [effect] if effect else []
    if not effects and kind in ("single", "outside"):
        effects = [choice(rng, SINGLES if kind == "single" else OUTSIDE)]
    while kind == "pair" and (len(set(effects)) < 2 or set(effects) in ALIKE):
        effects = [choice(rng, PAIRS), choice(rng, PAIRS)]
    bare = set(effects) <= WITHOUT_SIMULATION and rng.random() < SHARE_WITHOUT
    return kind, "none" if bare else choice(rng, MODELS), effects
