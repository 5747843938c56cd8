"""Friction points under rising load, solved one contact after the other until none changes.

A contact's correction is what its springs would bear beyond its law, g = k u - f(u): it is constant
while the contact sticks. The normal load is constant, so that motions have the two tangential
components alone.
"""

from typing import no_type_check

import numpy as np

from bladeroot.compiled import njit

_MOST_SWEEPS = 500  # over all contacts, for one state
_MOST_ITERATIONS = 40  # of Newton's method, for one contact
_STUCK_TOLERANCE = 1e-13  # of a contact's force: a smaller change of its correction is none


@njit(cache=True, error_model="numpy")
@no_type_check
def pull(kt, limit, w, x, y):
    """Force of one contact's sliders at (x, y), its derivative (xx, xy, yy), and whether one slips.

    limit: largest force of each slider (N); w: place of its friction point (m).
    """
    fx, fy, xx, xy, yy, slips = 0.0, 0.0, 0.0, 0.0, 0.0, False
    for s in range(kt.size):
        ex, ey = x - w[s, 0], y - w[s, 1]
        square = ex * ex + ey * ey
        if kt[s] * kt[s] * square > limit[s] * limit[s]:  # most stick: no root for those
            slips, size = True, np.sqrt(square)
            ex, ey, turn = ex / size, ey / size, limit[s] / size
            fx += limit[s] * ex
            fy += limit[s] * ey
            xx += turn * ey * ey
            xy -= turn * ex * ey
            yy += turn * ex * ex
        else:
            fx += kt[s] * ex
            fy += kt[s] * ey
            xx += kt[s]
            yy += kt[s]
    return fx, fy, xx, xy, yy, slips


@njit(cache=True, error_model="numpy")
@no_type_check
def settled(kt, limit, stuck, give, tolerance, w, u, g):
    """Sweep over the contacts until none changes its motion u by more than the tolerance (m).

    u and g (contact, component) are changed in place; u must hold the motion for the g given. give:
    row k is the motion of all by correction k. A contact's own u = free + give (stuck u - f(u)) is
    solved by Newton's method, whose last step is a hundredth of the tolerance: the next would be
    its square. Says whether it came to an end.
    """
    flat = u.reshape(-1)
    for _ in range(_MOST_SWEEPS):
        change = 0.0
        for c in range(stuck.size):
            k, x, y = stuck[c], u[c, 0], u[c, 1]
            fx, fy, xx, xy, yy, slips = pull(kt[c], limit[c], w[c], x, y)
            more_x, more_y = k * x - fx - g[c, 0], k * y - fy - g[c, 1]
            if (
                not slips
                and abs(more_x) <= _STUCK_TOLERANCE * k * abs(x)
                and abs(more_y) <= _STUCK_TOLERANCE * k * abs(y)
            ):
                continue
            one, two = give[2 * c], give[2 * c + 1]
            a11, a21, a12, a22 = one[2 * c], one[2 * c + 1], two[2 * c], two[2 * c + 1]
            free_x = x - a11 * g[c, 0] - a12 * g[c, 1]
            free_y = y - a21 * g[c, 0] - a22 * g[c, 1]
            size = np.inf
            for _step in range(_MOST_ITERATIONS):
                more_x, more_y = k * x - fx, k * y - fy
                rest_x = free_x - x + a11 * more_x + a12 * more_y
                rest_y = free_y - y + a21 * more_x + a22 * more_y
                l11 = 1.0 + a11 * (xx - k) + a12 * xy
                l12 = a11 * xy + a12 * (yy - k)
                l21 = a21 * (xx - k) + a22 * xy
                l22 = 1.0 + a21 * xy + a22 * (yy - k)
                whole = l11 * l22 - l12 * l21
                step_x = (l22 * rest_x - l12 * rest_y) / whole
                step_y = (l11 * rest_y - l21 * rest_x) / whole
                x, y = x + step_x, y + step_y
                fx, fy, xx, xy, yy, slips = pull(kt[c], limit[c], w[c], x, y)
                size = step_x * step_x + step_y * step_y
                if size <= (0.01 * tolerance) ** 2:
                    break
            if not size <= (0.01 * tolerance) ** 2:
                return False
            more_x, more_y = k * x - fx - g[c, 0], k * y - fy - g[c, 1]
            change = max(change, (x - u[c, 0]) ** 2 + (y - u[c, 1]) ** 2)
            g[c, 0] += more_x
            g[c, 1] += more_y
            for j in range(flat.size):
                flat[j] += one[j] * more_x + two[j] * more_y
        if change <= tolerance**2:
            return True
    return False


@njit(cache=True, error_model="numpy")
@no_type_check
def load_up(kt, limit, stuck, give, shape, master, tolerance):
    """Corrections g (state, contact and component) on first loading, and how many states settled.

    kt, limit: of each contact's sliders; stuck: their stiffness together (N/m). master: rising
    coordinates (m kg^1/2), `shape` the contacts' motion by them; tolerance: of the largest motion.
    Each state starts from the last two, continued.
    """
    w = np.zeros((*kt.shape, 2))
    g, u = np.zeros((stuck.size, 2)), np.empty((stuck.size, 2))
    flat, flat_g, before = u.reshape(-1), g.reshape(-1), np.zeros(shape.size)
    found = np.zeros((master.size, shape.size))
    for i in range(master.size):
        further = 0.0
        if i > 1:
            further = (master[i] - master[i - 1]) / (master[i - 1] - master[i - 2])
        for k in range(shape.size):
            more = flat_g[k] - before[k]
            before[k] = flat_g[k]
            flat_g[k] += further * more
            flat[k] = shape[k] * master[i]
        largest = 0.0
        for j in range(shape.size):
            if flat_g[j] != 0.0:
                for k in range(shape.size):
                    flat[k] += give[j, k] * flat_g[j]
        for k in range(shape.size):
            largest = max(largest, abs(flat[k]))
        if not settled(kt, limit, stuck, give, tolerance * largest, w, u, g):
            return found, i
        for c in range(stuck.size):
            for s in range(kt.shape[1]):
                ex, ey = u[c, 0] - w[c, s, 0], u[c, 1] - w[c, s, 1]
                size = np.sqrt(ex * ex + ey * ey)
                if kt[c, s] * size > limit[c, s]:
                    slipped = 1.0 - limit[c, s] / (kt[c, s] * size)
                    w[c, s, 0] += slipped * ex
                    w[c, s, 1] += slipped * ey
        for k in range(shape.size):
            found[i, k] = flat_g[k]
    return found, master.size
