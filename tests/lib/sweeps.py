"""Friction points solved one contact after the other, by Newton's method, until none changes.

A contact's correction is what its springs would bear beyond its law, g = k u - f(u): it is constant
while the contact sticks. Motions have three components a contact (normal, two tangential), or the
two tangential ones alone where the law leaves the normal spring linear.
"""

from typing import no_type_check

import numpy as np
from bladeroot.compiled import njit
from bladeroot.contact.laws.sliders import slide

SWEEPS, NEWTON = 500, 40


@njit(cache=True)
@no_type_check
def contact_force(kn, kt, n0, mu, varies, u, w, force, tangent):
    """Force and Jacobian of one contact's sliders at u; says whether one slips or is lifted off."""
    one = u.size - 2  # place of the first tangential component
    force[:] = 0.0
    tangent[:] = 0.0
    un = u[0] if one else 0.0
    moving = False
    for s in range(kn.size):
        normal, slope, limit, steeper, size, e1, e2, slips = slide(
            kn[s], kt[s], n0[s], mu[s], varies, un, u[one], u[one + 1], w[s, 0], w[s, 1]
        )
        if one:
            force[0] += normal
            tangent[0, 0] += slope
            moving = moving or slope != kn[s]
        if slips:
            moving = True
            turn = limit / size
            force[one] += limit * e1
            force[one + 1] += limit * e2
            if one:
                tangent[1, 0] += steeper * e1
                tangent[2, 0] += steeper * e2
            tangent[one, one] += turn * e2 * e2
            tangent[one, one + 1] -= turn * e1 * e2
            tangent[one + 1, one] -= turn * e1 * e2
            tangent[one + 1, one + 1] += turn * e1 * e1
        else:
            force[one] += kt[s] * e1
            force[one + 1] += kt[s] * e2
            tangent[one, one] += kt[s]
            tangent[one + 1, one + 1] += kt[s]
    return moving


@njit(cache=True)
@no_type_check
def solve_small(lead, x):
    """Gauss's elimination in place, without exchange of rows: near one times a stiff contact."""
    for a in range(x.size):
        for b in range(a + 1, x.size):
            part = lead[b, a] / lead[a, a]
            for c in range(a + 1, x.size):
                lead[b, c] -= part * lead[a, c]
            x[b] -= part * x[a]
    for a in range(x.size - 1, -1, -1):
        for c in range(a + 1, x.size):
            x[a] -= lead[a, c] * x[c]
        x[a] /= lead[a, a]


@njit(cache=True)
@no_type_check
def local_solve(
    kn, kt, n0, mu, varies, stuck, give, free, close, w, u, force, tangent, step, lead
):  # fmt: skip
    """Solve u = free + give (stuck u - f(u)) of one contact in place; says whether it settled.

    force, tangent: at u. A step as short as `close` (m) is the last one: the next would be its
    square.
    """
    for _ in range(NEWTON):
        for a in range(u.size):
            step[a] = free[a] - u[a]
            for b in range(u.size):
                step[a] += give[a, b] * (stuck[b] * u[b] - force[b])
                lead[a, b] = -give[a, b] * stuck[b]
                for c in range(u.size):
                    lead[a, b] += give[a, c] * tangent[c, b]
            lead[a, a] += 1.0
        solve_small(lead, step)
        size = 0.0
        for a in range(u.size):
            u[a] += step[a]
            size += step[a] ** 2
        contact_force(kn, kt, n0, mu, varies, u, w, force, tangent)
        if size <= close**2:
            return True
    return False


@njit(cache=True)
@no_type_check
def correct(kn, kt, n0, mu, varies, stuck, give, tolerance, w, u, g):
    """Sweep over the contacts until none changes its motion u by more than the tolerance (m).

    u and g (contact, component) are changed in place; u must hold the motion for the g given. give:
    row k is the motion of all by correction k. Returns the number of sweeps; SWEEPS if they did not
    settle, and minus one if Newton's method did not.
    """
    contacts, size = u.shape
    force, step, free, place, more = np.empty((5, size))
    tangent, lead = np.empty((2, size, size))
    flat = u.reshape(-1)
    for sweep in range(1, SWEEPS + 1):
        change = 0.0
        for c in range(contacts):
            moving = contact_force(kn[c], kt[c], n0[c], mu[c], varies, u[c], w[c], force, tangent)
            for a in range(size):
                more[a] = stuck[c, a] * u[c, a] - force[a] - g[c, a]
                moving = moving or abs(more[a]) > 1e-13 * stuck[c, a] * abs(u[c, a])
            if not moving:
                continue
            first = size * c
            block = give[first : first + size, first : first + size].T
            for a in range(size):
                place[a] = u[c, a]
                free[a] = u[c, a]
                for b in range(size):
                    free[a] -= block[a, b] * g[c, b]
            if not local_solve(
                kn[c], kt[c], n0[c], mu[c], varies, stuck[c], block, free, 0.01 * tolerance, w[c],
                place, force, tangent, step, lead,
            ):  # fmt: skip
                return -1
            moved = 0.0
            for a in range(size):
                more[a] = stuck[c, a] * place[a] - force[a] - g[c, a]
                g[c, a] += more[a]
                moved += (place[a] - u[c, a]) ** 2
            if moved == 0.0:
                continue
            change = max(change, moved)
            for a in range(size):
                row, amount = give[first + a], more[a]
                for k in range(flat.size):
                    flat[k] += row[k] * amount
        if change <= tolerance**2:
            return sweep
    return SWEEPS


@njit(cache=True)
@no_type_check
def settle(kn, kt, n0, mu, varies, count, u, w, tension):
    """Move the friction points to where u leaves them; the work they take by the mean tension."""
    one = u.shape[1] - 2
    work = 0.0
    for c in range(u.shape[0]):
        un = u[c, 0] if one else 0.0
        for s in range(kn.shape[1]):
            k = kt[c, s]
            _, _, limit, _, _, e1, e2, slips = slide(
                kn[c, s], k, n0[c, s], mu[c, s], varies, un, u[c, one], u[c, one + 1],
                w[c, s, 0], w[c, s, 1],
            )  # fmt: skip
            pull = limit if slips else k
            t1, t2 = pull * e1, pull * e2
            if slips:
                new1, new2 = u[c, one] - t1 / k, u[c, one + 1] - t2 / k
                gain = (t1 + tension[c, s, 0]) * (new1 - w[c, s, 0])
                gain += (t2 + tension[c, s, 1]) * (new2 - w[c, s, 1])
                work += 0.5 * count[c] * gain
                w[c, s, 0], w[c, s, 1] = new1, new2
            tension[c, s, 0], tension[c, s, 1] = t1, t2
    return work
