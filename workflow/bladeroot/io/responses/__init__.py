"""A sensor's own response, as a sheet names it (`high-pass 0.5 Hz`), undone: one file a kind.

`high_pass.py` is the kind `high-pass`, found by itself: `undone(samples, sampling_Hz, corner_Hz) ->
samples`.
"""

import importlib
import pkgutil
import re
from collections.abc import Callable
from functools import partial

from numpy import ndarray

_FORM = re.compile(r"([a-z-]{1,40}) {1,9}(\d{1,9}(?:\.\d{1,9})?) {0,9}Hz", re.ASCII)


def undoing(text: str) -> Callable[[ndarray, float], ndarray]:
    """What undoes a response: a function of samples and sampling frequency (Hz).

    Raises:
        ValueError: not a known kind with a positive frequency.
    """
    kinds = {one.name.replace("_", "-"): one.name for one in pkgutil.iter_modules(__path__)}
    form = _FORM.fullmatch(text.strip())
    if form is None or form[1] not in kinds or not float(form[2]) > 0.0:
        raise ValueError(
            f"response must be {' or '.join(sorted(kinds))} with its frequency, such as "
            f"`high-pass 0.5 Hz`, got {text!r}"
        )
    module = importlib.import_module(f"{__name__}.{kinds[form[1]]}")
    return partial(module.undone, corner_Hz=float(form[2]))
