"""Laws of contact stiffness over axial force, and what is thought of their parameters beforehand.

The laws that are compared are polynomials of ln k in x = ln(F / 12 kN). A law's matrix says which
of its parameters stands before which function of the force; an extension brings its own functions.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float
from numpy import ndarray

REFERENCE_FORCE = 12e3  # N

# Mean, standard deviation and origin of each parameter.
# The range that the thesis searched, 33 nodes times 1e4 to 1.5e5 N/mm (section 5.3), is mean plus
# and minus one standard deviation; its middle, 1.28 GN/m, is also what contact theory gives (6.16).
_LEVEL = (np.log(1.28e9), 1.36, "the thesis's range of search, contact theory in its middle")
# A smooth line contact stiffens with the logarithm of the force, exponent about 0.05; a rough one
# in proportion to it, exponent 1.
_EXPONENT = (0.5, 0.5, "smooth contact 0 (6.16), rough contact 1; Table 5.2 has 0.65 and 0.47")
_BEND = (0.0, 0.25, "no law known to us bends; room for full contact reached only at high force")

PRIORS = {
    "ln_kn": _LEVEL,
    "ln_kt": _LEVEL,
    "exponent": _EXPONENT,
    "exponent_kn": _EXPONENT,
    "exponent_kt": _EXPONENT,
    "bend_kn": _BEND,
    "bend_kt": _BEND,
}


def powers(force: Float[ndarray, "*point"]) -> Float[ndarray, "*point 3"]:
    """1, x and x^2 with x = ln(F / 12 kN)."""
    x = np.log(force / REFERENCE_FORCE)
    return np.stack([np.ones_like(x), x, x**2], axis=-1)


def slopes(force: Float[ndarray, "*point"]) -> Float[ndarray, "*point 3"]:
    """Derivatives of `powers` by force, 1/N."""
    x = np.log(force / REFERENCE_FORCE)
    return np.stack([np.zeros_like(x), np.ones_like(x), 2.0 * x], axis=-1) / force[..., None]


Functions = Callable[[Float[ndarray, "*point"]], Float[ndarray, "*point function"]]


@dataclass(frozen=True)
class Law:
    """ln k = sum over functions of the force of (matrix * parameters + constant) * function.

    The first two parameters are ln kn and ln kt at the reference force. constant: what no parameter
    stands before; None: nothing. functions, their slopes: of axial forces (N). priors: mean,
    standard deviation and origin of each parameter.
    """

    name: str
    parameters: tuple[str, ...]
    matrix: Float[ndarray, "stiffness function parameter"]
    constant: Float[ndarray, "stiffness function"] | None = None
    functions: Functions = powers
    slopes: Functions = slopes
    priors: Mapping[str, tuple[float, float, str]] = field(default_factory=lambda: PRIORS)

    def weights(
        self, theta: Float[ndarray, "*draw parameter"]
    ) -> Float[ndarray, "*draw stiffness function"]:
        """What stands before each function, in ln kn and ln kt."""
        with_parameters = np.einsum("kbt,...t->...kb", self.matrix, theta)
        return with_parameters if self.constant is None else with_parameters + self.constant


def _law(name: str, kn: tuple[str, ...], kt: tuple[str, ...]) -> Law:
    parameters = tuple(dict.fromkeys([*kn[:1], *kt[:1], *kn[1:], *kt[1:]]))
    matrix = np.zeros((2, 3, len(parameters)))
    for stiffness, terms in enumerate((kn, kt)):
        for power, term in enumerate(terms):
            matrix[stiffness, power, parameters.index(term)] = 1.0
    return Law(name, parameters, matrix)


LAWS = {
    law.name: law
    for law in (
        _law("constant", ("ln_kn",), ("ln_kt",)),
        _law("one power", ("ln_kn", "exponent"), ("ln_kt", "exponent")),
        _law("two powers", ("ln_kn", "exponent_kn"), ("ln_kt", "exponent_kt")),
        _law(
            "bent powers", ("ln_kn", "exponent_kn", "bend_kn"), ("ln_kt", "exponent_kt", "bend_kt")
        ),
    )
}
