"""Laws of contact stiffness over axial force: polynomials of ln k in x = ln(F / 12 kN)."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.stiffness.priors import REFERENCE_FORCE


def powers(force: Float[ndarray, "*point"]) -> Float[ndarray, "*point 3"]:
    """1, x and x^2 with x = ln(F / 12 kN)."""
    x = np.log(force / REFERENCE_FORCE)
    return np.stack([np.ones_like(x), x, x**2], axis=-1)


def slopes(force: Float[ndarray, "*point"]) -> Float[ndarray, "*point 3"]:
    """Derivatives of `powers` by force, 1/N."""
    x = np.log(force / REFERENCE_FORCE)
    return np.stack([np.zeros_like(x), np.ones_like(x), 2.0 * x], axis=-1) / force[..., None]


@dataclass(frozen=True)
class Law:
    """(ln kn, ln kt) = powers of the force, times a matrix, times the parameters.

    The first two parameters are ln kn and ln kt at the reference force.
    """

    name: str
    parameters: tuple[str, ...]
    matrix: Float[ndarray, "stiffness power parameter"]

    def ln_k(
        self, theta: Float[ndarray, "draw parameter"], force: Float[ndarray, " force"]
    ) -> Float[ndarray, "draw force 2"]:
        """(ln kn, ln kt) at axial forces (N)."""
        return np.einsum("fb,kbt,dt->dfk", powers(force), self.matrix, theta, optimize=True)

    def rows(self, force: Float[ndarray, " force"]) -> Float[ndarray, "force 2 parameter"]:
        """Derivatives of (ln kn, ln kt) by the parameters."""
        return np.einsum("fb,kbt->fkt", powers(force), self.matrix)


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
