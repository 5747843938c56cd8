"""Contacts moved along a whole history, step by step, with the exact derivative of their force."""

import numpy as np
from bladeroot.contact.laws.sliders import Sliders, load


def history(law, motion, state, seeds=None):
    """Force (N) along a motion (time, contact, 3; m), the last state, and the force's derivative.

    seeds: derivative of the motion by any parameters (last axis), of which the start does not
    depend; the derivative of the force is by the same ones. Each slider is a contact of its own:
    its force is a function of its motion less its friction point's.
    """
    contacts, sliders = law.tangential.shape
    parts = (law.normal, law.tangential, law.preload, law.friction)
    alone = Sliders(*(part.reshape(-1, 1) for part in parts), law.varies)
    seeds = np.zeros((*motion.shape, 0)) if seeds is None else seeds
    point, moved = state.reshape(-1, 1, 2), np.zeros((contacts * sliders, 2, seeds.shape[-1]))
    found = []
    for now, seed in zip(motion, seeds, strict=True):
        now, seed = (np.repeat(one, sliders, axis=0) for one in (now, seed))
        force, tangent, point, slips = load(alone, now, point)
        change = tangent @ np.concatenate([seed[:, :1], seed[:, 1:] - moved], axis=1)
        after = seed[:, 1:] - change[:, 1:] / alone.tangential[:, :, None]
        moved = np.where(slips[:, :, None], after, moved)
        found.append([one.reshape(contacts, sliders, 3, -1).sum(axis=1) for one in (force, change)])
    forces, derivatives = (np.array(one) for one in zip(*found, strict=True))
    return forces[..., 0], point.reshape(state.shape), derivatives
