"""Words that differ from specimen to specimen: what its load, its joint and its judge are called.

Sentences of the catalogue and of the diagnosis hold names in braces where these stand, such as
`{load}`; `Terms.say` puts the words in, once, where an artifact is written.
"""

import re
from dataclasses import dataclass

from bladeroot.loads import AXIAL_FORCE

# Columns of a table of simulated frequencies: derivatives of ln f by the contact stiffness.
CONTACT = ("by_ln_kn", "by_ln_kt")
_OF_MODES = ("linear modes explain", "linear modes", "than in a linear mode")
_OF_SIMULATION = ("the simulation explains", "the simulation without it", "than simulated")


@dataclass(frozen=True)
class Terms:
    """A campaign's own words.

    load: name of its load, or "". simulated: whether it is compared with a simulation, else with
    linear modes.
    """

    load: str = AXIAL_FORCE
    simulated: bool = True

    @property
    def words(self) -> dict[str, str]:
        """By the names that stand in braces; load and force are the long and the short name."""
        name = self.load or "preload of the joint"
        several = f"{name}s" if self.load else "preloads"
        made = {"load": name, "loads": several, "force": name, "forces": several}
        made |= {"beam": "specimen", "rig": "specimen", "beam_and_rig": "the specimen"}
        made |= {"flanks": "joint's surfaces", "stuck_joint": "plateau", "tip": "exciter"}
        made |= {"gauge": "reading", "second_measure": f"a second measure of the {name}"}
        if self.load == AXIAL_FORCE and self.simulated:
            made |= {"force": "force", "forces": "forces", "beam": "beam", "rig": "rig"}
            made |= {"beam_and_rig": "beam and rig", "flanks": "flanks"}
            made |= {"stuck_joint": "stuck joint", "tip": "shaker's tip", "gauge": "gauge"}
            made |= {"second_measure": "a load cell in the line of force"}
        judge = _OF_SIMULATION if self.simulated else _OF_MODES
        return made | dict(zip(("it_explains", "without_it", "than_simulated"), judge, strict=True))

    def say(self, text: str) -> str:
        """A sentence with the words in it; other braces stay."""
        for name, word in self.words.items():
            text = text.replace(f"{{{name}}}", word)
        return text


DOVETAIL = Terms()  # the catalogue's own


def spelled(name: str) -> str:
    """A mechanism's id as words: `joint slip`."""
    return re.sub(r"(?<=[a-z])-(?=[a-z])", " ", name)


def length(metres: float) -> str:
    """A length in the unit that needs no exponent: `12 µm`, `2.51 mm`."""
    if metres < 1e-8:
        return f"{1e9 * metres:.3g} nm"
    return f"{1e3 * metres:.3g} mm" if metres >= 1e-3 else f"{1e6 * metres:.3g} µm"
