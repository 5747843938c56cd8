"""Micro-slip of the flanks: sliders of several densities, Iwan, Mindlin, Dahl."""

import numpy as np

from foreign_lab.laws import _sliders

ID, UNIT = "joint-slip", "largest rise of the loss factor at the middle load"
SIZES = (1e-3, 8e-3)


def _common(rng) -> dict:
    return {
        "rest": 0.0 if rng.random() < 0.5 else float(rng.uniform(0.1, 0.6)),
        "friction_over_force": float(rng.uniform(0.7, 1.3)),
    }


FORMS = {
    "power": lambda r: _common(r) | {"power": float(r.uniform(0.6, 3.0))},
    "lognormal": lambda r: _common(r) | {"spread": float(r.uniform(0.3, 1.2))},
    "uniform": lambda r: _common(r) | {"first": float(r.uniform(0.0, 0.4))},
    "iwan": lambda r: (
        _common(r) | {"chi": float(r.uniform(-0.8, -0.2)), "last": float(r.uniform(0.0, 0.4))}
    ),
    "mindlin": _common,
    "cattaneo-line": _common,
    "dahl": _common,
    "two-patches": lambda r: _common(r) | {"edge": float(r.uniform(0.15, 0.5))},
}


def _threshold(effect, record) -> float:
    """Laser amplitude (m) at which the last sliders of the record's mode slip."""
    shape = dict(effect.shape)
    grow = record.load ** shape["friction_over_force"]
    middle = _scale(effect, record.sheet)
    first = record.sheet.specimen.surfaces["1B"]
    stiff = np.exp(record.sheet.specimen.ln_kt - record.at("ln_kt"))
    return middle * grow * stiff * first.slip / record.surface.slip


def _shape(effect) -> dict:
    return {k: v for k, v in effect.shape.items() if k != "friction_over_force"}


def _scale(effect, sheet) -> float:
    """Threshold of 1B at the middle load so that the loss factor rises by the size there.

    The largest rise below the onset of gross slip bounds what a threshold can reach.
    """
    surface = sheet.specimen.surfaces["1B"]
    point = (sheet.specimen.ln_kn, sheet.specimen.ln_kt, sheet.reference)
    share = 2.0 * float(surface.slope(1, *point))
    start = sheet.usual_start("1B")
    u = np.geomspace(1e-3, 30, 400)
    rise = share * _sliders.respond(effect.form, _shape(effect), u)[1] / np.pi
    wanted = min(effect.size, 0.8 * rise.max())
    return start / u[int(np.argmax(rise >= wanted))]


def curve(effect, record, x):
    """Softening and loss of the tangential stiffness, with odd harmonics."""
    u = x / _threshold(effect, record)
    left, energy, third = _sliders.respond(effect.form, _shape(effect), u)
    left = np.maximum(left, 0.13)
    share = record.share(1, left)
    return {
        "ln_f": record.softened(1, left),
        "eta": share * energy / (np.pi * left),
        "odd": share * third / left / 8.0,
    }
