"""Small systems for tests of the nonlinear room: one degree of freedom, and a coarse dovetail."""

from functools import cache

import numpy as np
from bladeroot.contact.laws.jenkins import jenkins
from bladeroot.nonlinear.system import System
from bladeroot.rom.joint import joint_of_reduced
from bladeroot.rom.reduction import reduce_structure
from structure_coarse import coarse_loaded

MASS, SPRING, TANGENTIAL, LIMIT = 0.7, 4.2e6, 4e6, 400.0  # section 3.4 of the thesis
X_CR = LIMIT / TANGENTIAL
NORMAL, FRICTION = 1e6, 0.08


def one_dof(loss=0.0, contact=TANGENTIAL, angle=0.0, images=1.0):
    """A mass on a spring and a slider; the laser looks at the mass.

    The slider lies at an angle in its plane and is `images` times a part of itself.
    """
    root = 1.0 / np.sqrt(MASS)
    return System(
        mode="1B",
        values=np.array([(SPRING + contact) / MASS]),
        loss=np.array([loss]),
        shape=root * np.array([0.0, np.cos(angle), np.sin(angle)]).reshape(1, 3, 1),
        flexibility=np.zeros((1, 3, 1, 3)),
        laser=np.array([root]),
        laser_flexibility=np.zeros((1, 3)),
        count=np.array([images]),
        stiffness=np.array([[NORMAL, contact / images]]),
        pair=np.array([0]),
        image=np.array([0]),
        sign=np.ones((1, 3)),
    )


def sliding_mass(contact=TANGENTIAL, limit=LIMIT, angle=0.0, images=1.0):
    """The same system, and the law of its slider."""
    part = np.ones(1) / images
    law = jenkins(NORMAL * np.ones(1), contact * part, limit / FRICTION * part, FRICTION)
    return one_dof(0.0, contact, angle, images), law


@cache
def coarse_joint():
    return joint_of_reduced(reduce_structure(*coarse_loaded()))
