"""The checker of shapes and types: `pytest --jaxtyping-packages=bladeroot,shapes.checked`."""

import ast

from beartype import BeartypeConf, beartype
from jaxtyping import _import_hook

# A whole number is a float, as PEP 484 has it: files say 7850.
checked = beartype(conf=BeartypeConf(is_pep484_tower=True))


class OuterAlone(_import_hook.JaxtypingTransformer):
    """What a function defines inside is wrapped anew at each of its calls: half of the cost."""

    def generic_visit(self, node: ast.AST) -> None:
        inside = isinstance(node, ast.FunctionDef)
        self._no_type_check_level += inside
        super().generic_visit(node)
        self._no_type_check_level -= inside


def check_outer_functions_alone() -> None:
    _import_hook.JaxtypingTransformer = OuterAlone
