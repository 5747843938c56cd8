"""A sensor's own response, as a sheet names it (`high-pass 0.5 Hz`), undone: one file a kind.

`high_pass.py` is such a kind, found by itself. It has `EXAMPLE`, what a sheet may say of it, and
`undone(samples, sampling_Hz, ...) -> samples`, with an argument for each number of the example.
"""

import importlib
import inspect
import pkgutil
import re
from collections.abc import Callable
from functools import partial

from numpy import ndarray

_NUMBER = re.compile(r"\d+(?:\.\d+)?", re.ASCII)


def undoing(text: str) -> Callable[[ndarray, float], ndarray]:
    """What undoes a response: a function of samples and sampling frequency (Hz).

    Raises:
        ValueError: nothing like any kind's example with positive numbers.
    """
    names = [one.name for one in pkgutil.iter_modules(__path__)]
    kinds = [importlib.import_module(f"{__name__}.{name}") for name in names]
    for kind in kinds:
        form = _form(kind.EXAMPLE).fullmatch(text.strip())
        numbers = [float(number) for number in form.groups()] if form else []
        if numbers and min(numbers) > 0.0:
            own = list(inspect.signature(kind.undone).parameters)[2:]
            return partial(kind.undone, **dict(zip(own, numbers, strict=True)))
    like = " or ".join(f"`{kind.EXAMPLE}`" for kind in kinds)
    raise ValueError(f"response must be like {like}, with positive numbers, got {text!r}")


def _form(example: str) -> re.Pattern[str]:
    """What is like an example: any numbers, more or no blanks before a unit."""
    words = [re.escape(word) for word in _NUMBER.sub("\0", example).split(" ")]
    number = r"(\d{1,9}(?:\.\d{1,9})?)"
    return re.compile(r"[ ]{0,9}".join(words).replace(re.escape("\0"), number), re.ASCII)
