"""From ring-down records of a blade-root joint to contact stiffness (see README.md).

import bladeroot as br

decay = br.ringdown("a.wav", mode_Hz=540, sensitivity="500 mm/s/FS")
joint = br.Joint.from_matrices(K, M, pairs, modes={"1B": 1, "2B": 2}, Kg=Kg)
fit = br.fit_contact(joint, {"1B": (541.2, 0.05), "2B": (1452.0, 0.1)}, load=12e3)
verdict = br.diagnose("path/to/campaign")
"""

from importlib import import_module
from importlib.metadata import version

__version__ = version("bladeroot")

# The public face, loaded when it is asked for: a stage of the workflow needs none of it.
_FACE = {
    "ringdown": "decay",
    "Ringdown": "decay",
    "ContactPairs": "joint",
    "Joint": "joint",
    "ContactFit": "contact_fit",
    "fit_contact": "contact_fit",
    "Verdict": "diagnosis",
    "diagnose": "diagnosis",
    "export": "export",
}
__all__ = sorted(_FACE)


def __getattr__(name: str):
    if name not in _FACE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.public.{_FACE[name]}"), name)


def __dir__() -> list[str]:
    return [*globals(), *_FACE]
