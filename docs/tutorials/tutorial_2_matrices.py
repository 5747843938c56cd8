"""
Contact stiffness with matrices of your own
===========================================

Two bars that touch at their ends, free to move, from their matrices to the stiffness of the contact.
"""

import bladeroot as br
import numpy as np

# %%
# Each bar is a chain of masses and springs in three directions; any finite-element program's matrices would do.


def chain(nodes, stiffness, mass):
    """Stiffness and mass of a chain, the same in all three directions."""
    step = np.diff(np.eye(nodes), axis=0)
    return np.kron(stiffness * step.T @ step, np.eye(3)), mass * np.eye(3 * nodes)


first, second = chain(12, 4e8, 0.05), chain(9, 3e8, 0.06)
zero = np.zeros((first[0].shape[0], second[0].shape[0]))
K, M = (np.block([[a, zero], [zero.T, b]]) for a, b in zip(first, second, strict=True))

# %%
# The last node of one bar touches the first of the other; the contact's normal is x.

pairs = br.ContactPairs(
    first=np.array([[33, 34, 35]]),
    second=np.array([[36, 37, 38]]),
    normal=np.array([[1.0, 0.0, 0.0]]),
    area=np.array([1.0]),
)
joint = br.Joint.from_matrices(K, M, pairs, modes={"sway": 1, "stretch": 3, "second stretch": 6})
joint

# %%
# What a measurement would give, if kn and kt were these:

truth = np.log([2e8, 5e7])
measured = joint.modes_at(truth).frequency
measured

# %%
# Two frequencies give the two stiffnesses; ``fe_bias`` is how far the model's own frequencies are trusted.

two = {name: (f, 0.02) for name, f in zip(joint.modes, measured, strict=True)}
two.pop("second stretch")
br.fit_contact(joint, two, fe_bias=1e-3)

# %%
# A third frequency can show that the model is wrong. Here the specimen is 1 % heavier than its matrices say:

heavy = (
    br.Joint.from_matrices(K, 1.01 * M, pairs, modes=dict(joint.modes)).modes_at(truth).frequency
)
three = {name: (f, 0.02) for name, f in zip(joint.modes, heavy, strict=True)}
br.fit_contact(joint, three, fe_bias=1e-4)
