"""The checker of shapes and types: `pytest --jaxtyping-packages=bladeroot,shapes.checked`."""

import ast
from collections import Counter
from collections.abc import Callable
from functools import wraps
from inspect import isclass
from types import FunctionType

import jaxtyping
from beartype import BeartypeConf, beartype
from jaxtyping import _import_hook

# A whole number is a float, as PEP 484 has it: files say 7850.
checked = beartype(conf=BeartypeConf(is_pep484_tower=True))
# Calls of a function that are checked in a test: a fit calls some thousands of times, alike.
FIRST = 20
calls: Counter = Counter()


class OuterAlone(_import_hook.JaxtypingTransformer):
    """What a function defines inside is wrapped anew at each of its calls: half of the cost."""

    def generic_visit(self, node: ast.AST) -> None:
        inside = isinstance(node, ast.FunctionDef)
        self._no_type_check_level += inside
        super().generic_visit(node)
        self._no_type_check_level -= inside


def check_outer_functions_at_first() -> None:
    _import_hook.JaxtypingTransformer = OuterAlone
    whole = jaxtyping.jaxtyped

    def at_first(**options) -> Callable:
        def decorated(made):
            plain = made.__init__ if isclass(made) else made
            checking = whole(**options)(made)
            if not isclass(made):
                return sparing(plain, checking)
            if checking.__init__ is not plain:
                checking.__init__ = sparing(plain, checking.__init__)
            return checking

        return decorated

    jaxtyping.jaxtyped = at_first


def sparing(plain: Callable, checking: Callable) -> Callable:
    if not isinstance(plain, FunctionType):
        return checking

    @wraps(plain)
    def called(*args, **kwargs):
        calls[plain] += 1
        return (checking if calls[plain] <= FIRST else plain)(*args, **kwargs)

    return called
