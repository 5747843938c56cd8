"""Two masses in a row, each held to the ground by its own springs in x, y and z, and in contact.

Along the normal x with kn, across it with kt. In each direction two modes; the one in which the
masses move against each other knows the contact.
"""

import bladeroot as br
import numpy as np

MASS, GROUND = 2.0, 3e6


def two_masses(normal=(1.0, 0.0, 0.0), interface=()):
    pairs = br.ContactPairs(
        np.array([[0, 1, 2]]), np.array([[3, 4, 5]]), np.array([normal]), np.ones(1), interface
    )
    # the ground's springs differ a little, so that no two modes are one
    K = np.diag(GROUND * np.array([1.0, 1.1, 1.2, 1.0, 1.1, 1.2]))
    return K, MASS * np.eye(6), pairs


def against(axis):
    shape = np.zeros(6)
    shape[[axis, axis + 3]] = 1.0, -1.0
    return shape


def closed_form(k, axis):
    return np.sqrt((GROUND * (1.0, 1.1, 1.2)[axis] + 2.0 * k) / MASS) / (2.0 * np.pi)
