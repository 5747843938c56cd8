"""What every law file of `laws/` says, and the pool of them.

A file is one physical effect: `ID`, `UNIT`, `SIZES` (smallest and largest size), `FORMS` (name to a
function of a generator that draws the shape's parameters) and one or more hooks. `SIGNED` where the
size may have either sign; `OUTSIDE` where no catalogue is known to have it, with `KIN`, the ids
that would be a fair description of it. Hooks get the effect and the sheet of records (`sheet.py`):

    stick(effect, sheet)               changes by record: ln_kn, ln_kt, force, ln_f, ln_eta
    curve(effect, record, x)           changes at amplitudes x (m, laser): ln_f, eta, even, odd
    signal(effect, record, rng, t, v)  the velocity that is recorded instead of v
    measures(effect, sheet)            the size in numbers that all forms share
"""

import importlib
import pkgutil
from dataclasses import dataclass, replace
from types import ModuleType
from typing import Any

import numpy as np

from foreign_lab import laws


@dataclass(frozen=True)
class Effect:
    """One hidden effect: its law's module, the form of the law, size and shape."""

    law: ModuleType
    form: str
    size: float
    shape: dict[str, Any]

    @property
    def id(self) -> str:
        """The id of the effect."""
        return self.law.ID

    @property
    def outside(self) -> bool:
        """Whether no catalogue is known to have it."""
        return getattr(self.law, "OUTSIDE", False)

    @property
    def kin(self) -> tuple[str, ...]:
        """Ids that describe it fairly though they are not its own."""
        return getattr(self.law, "KIN", ())

    def call(self, hook: str, *given) -> Any:
        """The hook's answer, None if the law has no such hook."""
        function = getattr(self.law, hook, None)
        return None if function is None else function(self, *given)

    def larger(self, factor: float) -> "Effect":
        """The same with another size, at most the law's largest."""
        return replace(
            self, size=np.sign(self.size) * min(abs(self.size) * factor, self.law.SIZES[1])
        )

    def at_most(self) -> bool:
        """Whether its size is the law's largest."""
        return abs(self.size) >= self.law.SIZES[1]


def pool(spare: bool = False) -> dict[str, ModuleType]:
    """All law files by id, in the order of the ids; with those of `_` that are drawn on demand."""
    names = [info.name for info in pkgutil.iter_modules(laws.__path__)]
    names = [name for name in names if name[0] != "_" or spare]
    found = [importlib.import_module(f"foreign_lab.laws.{name}") for name in names]
    found = [law for law in found if hasattr(law, "ID")]
    return {law.ID: law for law in sorted(found, key=lambda law: law.ID)}


def draw_effect(rng: np.random.Generator, law: ModuleType) -> Effect:
    """Form uniform, size log-uniform between the law's ends."""
    form = sorted(law.FORMS)[rng.integers(len(law.FORMS))]
    size = float(np.exp(rng.uniform(*np.log(law.SIZES))))
    if getattr(law, "SIGNED", False) and rng.random() < 0.5:
        size = -size
    return Effect(law, form, size, law.FORMS[form](rng))
