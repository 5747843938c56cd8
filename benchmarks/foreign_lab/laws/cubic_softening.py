"""A root that softens without any loss: the bulk's own law, or rotation of the slot."""

ID, UNIT, OUTSIDE = "cubic-softening", "fall of ln f at the usual start", True
SIZES = (5e-4, 5e-3)
KIN = ("cubic-softening",)
FORMS = {
    "cubic": lambda r: {"power": 2.0},
    "absolute": lambda r: {"power": 1.0},
    "quintic": lambda r: {"power": 4.0},
}


def curve(effect, record, x):
    """A power of the amplitude, whatever the load, alike in all modes."""
    fall = effect.size * (x / record.at("start")) ** effect.shape["power"]
    return {"ln_f": -fall, "odd": fall / 12}
