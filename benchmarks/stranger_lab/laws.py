"""What is hidden: sizes as they are drawn, and what they do to load, contact and curves."""

from dataclasses import dataclass

import numpy as np

from stranger_lab.friction import FORMS, softening

REFERENCE = 8e3  # N: laws over the load are 1 here
# Uniform between two numbers, one of a list, or a word for every seed.
SIZES = {
    "slip": {"form": FORMS, "threshold": (0.15, 0.5), "share": (0.5, 1.0), "spread": (0.4, 0.9),
             "density": (-0.6, 0.5), "exponent": [1.0, 1.5, 2.0], "by_load": [0.7, 1.0, 0.5],
             "by_speed": [0, 0, 0, 1], "speed": (0.01, 0.04)},
    "normal-load": {"size": (0.25, 0.5), "from": (0.05, 0.2)},
    "contact-law": {"form": ["power", "hertz", "rough", "saturating", "log"], "power": (0.3, 0.7),
                    "log": (0.25, 0.4), "force_N": (5e3, 2e4), "least": (0.1, 0.4),
                    "tangential": (0.7, 1.0)},
    "seating": {"force_N": (4e3, 8e3), "steepness": (3, 6), "least": (0.25, 0.5)},
    "zero": {"sign": [-1, 1], "force_N": (800, 1700)},
    "gain": {"sign": [-1, 1], "size": (0.06, 0.12)},
    "lagging-load": {"size": (0.05, 0.12)},
    "relaxation": {"per_decade": (0.06, 0.14)},
    "temperature": {"range_K": (6, 14), "per_K": (-4e-4, -2e-4), "cycles_a_day": (0.8, 2.2)},
    "drift": {"sign": [-1, 1], "size": (0.002, 0.006), "power": (0.6, 1.6)},
    "ageing": {"form": ["log", "exp", "count"], "size": (0.15, 0.4)},
    "tip-mass": {"mass_kg": (0.004, 0.015)},
    "crack": {"size": (0.25, 0.5), "power": (1, 2.5), "at": (0.05, 0.4)},
    "hardening": {f"mode{j}": (0.004, 0.02) for j in range(4)},
    "drag": {"loss": (0.002, 0.006)},
    "clipping": {"share": (0.3, 0.9), "part": (0.08, 0.25)},
    "hum": {"size": (0.01, 0.04)},
    "beating": {"sign": [-1, 1], "apart": (0.02, 0.06), "size": (0.06, 0.15)},
    "touch": {"share": (0.3, 0.7), "loss": (0.08, 0.2), "shift_s": (0.0, 5e-4)},
    "cable": {"size": (0.003, 0.008)},
    "rattle": {"level_g": (0.5, 3), "mass": (-0.003, -0.001), "loss": (0.001, 0.004)},
    "humidity": {"size": (0.15, 0.35)},
    "operator": {"soft": (0.15, 0.35), "sign": [-1, 1], "size": (0.002, 0.005)},
    "magnet": {"loss": (0.002, 0.005), "loaded": [0, 1], "by_load": (0.3, 0.8)},
    "rubber": {"memory_s": (0.15, 0.6), "soft": (0.004, 0.012), "loss": (0.3, 1.0)},
    "breathing": {"size": (0.002, 0.006)},
}  # fmt: skip


def draw(name: str, rng: np.random.Generator) -> dict:
    """Sizes of one effect: a pair of numbers is uniform between them, others are chosen from."""
    found = {}
    for key, of in SIZES[name].items():
        between = isinstance(of, tuple) and not isinstance(of[0], str)
        found[key] = float(rng.uniform(*of)) if between else of[int(rng.integers(len(of)))]
    return found


def true_load(effects: dict, stated: float, direction: str, since_clamping_s: float) -> float:
    """Load on the specimen (N) where the gauge states another."""
    load = stated
    if one := effects.get("gain"):
        load *= 1 + one["sign"] * one["size"]
    if one := effects.get("zero"):
        load += one["sign"] * one["force_N"]
    if one := effects.get("lagging-load"):
        load *= 1 + (one["size"] if direction == "down" else -one["size"])
    if one := effects.get("relaxation"):
        load *= 1 - one["per_decade"] * np.log10(1 + since_clamping_s / 60)
    return load


def _contact_law(law: dict, load: float) -> float:
    """ln of contact stiffness at a load (N), but for a constant."""
    return {
        "power": law["power"] * np.log(load / REFERENCE),
        "hertz": np.log(load / REFERENCE) / 3,
        "rough": np.log(load / (load + law["force_N"])),
        "saturating": np.log(law["least"] + 1 - np.exp(-load / law["force_N"])),
        "log": np.log(1 + law["log"] * np.log(load / REFERENCE)),
    }[law["form"]]


def contact(effects: dict, load: float, passed: float, clamped: float, span_s: float):
    """Changes of ln kn and ln kt at a load (N), after shares of the time and of the clampings."""
    normal = tangential = 0.0
    if one := effects.get("contact-law"):
        change = _contact_law(one, load) - _contact_law(one, REFERENCE)
        normal, tangential = change, change * one["tangential"]
    if one := effects.get("seating"):
        seated = 1 / (1 + np.exp(-one["steepness"] * np.log(load / one["force_N"])))
        change = np.log(one["least"] + (1 - one["least"]) * seated)
        normal, tangential = normal + change, tangential + change
    if one := effects.get("ageing"):
        hours = np.log10(1 + passed * span_s / 1800) / np.log10(1 + span_s / 1800)
        grown = {"log": hours, "exp": 1 - np.exp(-3 * passed), "count": clamped**0.7}
        change = one["size"] * grown[one["form"]]
        normal, tangential = normal + change, tangential + change
    return normal, tangential


def frequency_factor(effects: dict, warmer_K: float, passed: float, second_operator: bool) -> float:
    """What all frequencies are multiplied by."""
    factor = 1.0
    if one := effects.get("temperature"):
        factor *= 1 + one["per_K"] * warmer_K
    if one := effects.get("drift"):
        factor *= 1 + one["sign"] * one["size"] * passed ** one["power"]
    if second_operator and (one := effects.get("operator")):
        factor *= 1 + one["sign"] * one["size"]
    return factor


@dataclass
class Mode:
    """A mode in one record, over amplitudes of displacement."""

    number: int
    amplitude: np.ndarray  # m
    largest: float  # m, of the first mode in the campaign
    frequency_Hz: float
    loss: float
    ratio: float  # the first mode's frequency over this one's, and so of their motions
    load: float  # over the reference
    by_kn: float  # d ln f / d ln k
    by_kt: float
    humid: float  # of the day and the hour, -1.5 to 1.5

    @property
    def motion(self) -> np.ndarray:
        """Amplitude over the mode's largest."""
        return self.amplitude / (self.ratio * self.largest)


def curve(effects: dict, mode: Mode) -> tuple[np.ndarray, np.ndarray]:
    """Changes of ln f, and loss factor, over amplitude."""
    ln_f = np.zeros_like(mode.amplitude)
    loss = np.full_like(ln_f, mode.loss)
    for name, size in effects.items():
        if name in CURVES:
            more_f, more_loss = CURVES[name](size, mode)
            ln_f, loss = ln_f + more_f, loss + more_loss
    return ln_f, loss


def _slip(size, mode):
    """Sliders whose thresholds grow with the load; in a quarter they resist more when slow."""
    threshold = size["threshold"] * mode.load ** size["by_load"]
    lost, loss = softening(size, mode.motion / threshold)
    if size["by_speed"]:
        speed = mode.amplitude / mode.ratio * 2 * np.pi * mode.frequency_Hz  # m/s
        slow = np.exp(-speed / size["speed"])
        lost, loss = lost * (1 + 0.3 * slow), loss * (1 + 0.7 * slow)
    share = size["share"] * mode.by_kt
    return share * np.log(1 - np.minimum(lost, 0.95)), 2 * share * loss


def _normal_load(size, mode):
    """Surfaces part above a motion, less under load."""
    beyond = np.maximum(mode.motion - size["from"], 0) ** 1.5
    return -size["size"] * mode.by_kn * beyond / mode.load, 0.0


def _hardening(size, mode):
    """A cubic spring, of its own size in each mode."""
    return 0.5 * np.log1p(size[f"mode{mode.number % 4}"] * mode.motion**2), 0.0


def _cable(size, mode):
    """Stiffness that grows with the motion and saturates."""
    grown = 1 - 1 / np.sqrt(1 + (mode.motion / 0.3) ** 2)
    return size["size"] * grown * np.sqrt(mode.ratio), 0.0


def _magnet(size, mode):
    """Loss beside the motion, less in higher modes; it may grow with the load."""
    loaded = size["loaded"] * size["by_load"]
    return 0.0, size["loss"] * mode.ratio * (1 + loaded * (mode.load - 1))


def _rattle(size, mode):
    """A loose mass that lifts off above an acceleration."""
    level = mode.amplitude * (2 * np.pi * mode.frequency_Hz) ** 2 / 9.81 / size["level_g"]
    window = 1 / (1 + level**-4)
    return size["mass"] * window, size["loss"] * window * np.exp(-level / 6)


CURVES = {
    "slip": _slip,
    "normal-load": _normal_load,
    "hardening": _hardening,
    "drag": lambda size, mode: (0.0, size["loss"] * mode.motion),
    "cable": _cable,
    "magnet": _magnet,
    "humidity": lambda size, mode: (0.0, mode.loss * size["size"] * mode.humid),
    "rattle": _rattle,
    "breathing": lambda size, mode: (-size["size"] * np.tanh(mode.motion / 0.08), 0.0),
}
