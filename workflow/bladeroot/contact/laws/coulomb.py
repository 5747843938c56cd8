"""Coulomb friction under the momentary normal load, with lift-off, in the contact's plane."""

from dataclasses import replace

from jaxtyping import Float
from numpy import ndarray

from bladeroot.contact.laws.jenkins import jenkins
from bladeroot.contact.laws.sliders import Sliders


def coulomb(
    normal: Float[ndarray, " contact"],
    tangential: Float[ndarray, " contact"],
    preload: Float[ndarray, " contact"],
    friction: float,
) -> Sliders:
    """Contacts as Jenkins's, but the normal load is preload plus normal stiffness times approach.

    Where it would be negative the contact is open: no force, and the friction point follows.
    """
    return replace(jenkins(normal, tangential, preload, friction), varies=True)
