"""A small beam in two slots with the shape of a reduced structure, for the tests of the bench."""

import numpy as np
import xarray as xr

LENGTH, WIDTH, HEIGHT = 0.31, 0.026, 0.010
MODULUS, DENSITY = 200.3e9, 7592.0


def toy_reduced(elements: int = 8, across: int = 3, wide: int = 3) -> xr.Dataset:
    """Bernoulli beam whose ends carry four flanks of `across` x `wide` pairs on stiff springs.

    Generalised dofs after the contact dofs: w and slope of every beam node, then ux and uy of the
    two ends. The slots are masses on ground springs, one a contact dof.
    """
    nodes = elements + 1
    x = np.linspace(-LENGTH / 2, LENGTH / 2, nodes)
    frames, position, flank, weight = _flanks(across, wide)
    pairs = len(flank)
    contact = 3 * pairs
    total = contact + 2 * nodes + 4
    w_dof = contact + 2 * np.arange(nodes)
    end_dof = contact + 2 * nodes + np.array([[0, 1], [2, 3]])

    mass, stiff, geometric = (np.zeros((total, total)) for _ in range(3))
    section = WIDTH * HEIGHT
    inertia = WIDTH * HEIGHT**3 / 12
    h = x[1] - x[0]
    for e in range(elements):
        dofs = np.array([w_dof[e], w_dof[e] + 1, w_dof[e + 1], w_dof[e + 1] + 1])
        block = np.ix_(dofs, dofs)
        k, m, g = _element(h)
        stiff[block] += MODULUS * inertia * k
        mass[block] += DENSITY * section * m
        geometric[block] += g
    for axis in range(2):
        a, b = end_dof[0, axis], end_dof[1, axis]
        row = np.zeros(total)
        row[a], row[b] = -1, 1
        stiff += MODULUS * section / LENGTH * np.outer(row, row)
        mass[a, a] += DENSITY * section * LENGTH / 2
        mass[b, b] += DENSITY * section * LENGTH / 2
    for pair in range(pairs):
        end = 0 if position[pair, 0] < 0 else nodes - 1
        rigid = np.zeros((3, total))
        rigid[0, end_dof[min(end, 1), 0]] = 1
        rigid[0, w_dof[end] + 1] = -position[pair, 2]
        rigid[1, end_dof[min(end, 1), 1]] = 1
        rigid[2, w_dof[end]] = 1
        rigid[2, w_dof[end] + 1] = position[pair, 0] - x[end]
        for axis in range(3):
            row = -rigid[axis]
            row[3 * pair + axis] += 1
            stiff += 3e9 / across / wide * np.outer(row, row)
            mass[3 * pair + axis, 3 * pair + axis] += 1e-3
    display = np.zeros((nodes, 3, total))
    display[np.arange(nodes), 2, w_dof] = 1

    slot_pairs = np.array([np.flatnonzero(position[:, 0] < 0), np.flatnonzero(position[:, 0] > 0)])
    ground = np.eye(3 * slot_pairs.shape[1])
    return xr.Dataset(
        {
            "pair_position": (("pair", "axis"), position),
            "pair_flank": ("pair", flank),
            "pair_weight": ("pair", weight),
            "flank_frame": (("flank", "local", "axis"), frames),
            "beam_mass": (("beam_dof", "beam_dof_"), mass),
            "beam_stiffness": (("beam_dof", "beam_dof_"), stiff),
            "beam_geometric_stiffness": (("beam_dof", "beam_dof_"), geometric),
            "display_position": (
                ("display", "axis"),
                np.column_stack([x, 0 * x, 0 * x + HEIGHT / 2]),
            ),
            "display_shape": (("display", "axis", "beam_dof"), display),
            "slot_mass": (("slot", "slot_dof", "slot_dof_"), np.array([0.02 * ground] * 2)),
            "slot_stiffness": (("slot", "slot_dof", "slot_dof_"), np.array([1e9 * ground] * 2)),
            "slot_pairs": (("slot", "slot_pair"), slot_pairs),
        }
    )


def toy_bench(**changes: dict) -> dict:
    """A bench for the toy; each keyword replaces keys of one section (or a top-level value)."""
    bench = {
        "seed": 7,
        "specimen": {
            "modulus_factor": 1.0,
            "density_factor": 1.0,
            "added_mass_kg": 0.002,
            "added_mass_x_mm": 4,
            "modes": 10,
        },
        "joint": {
            "reference_force_N": 12000,
            "kn_N_per_m": 1.4e9,
            "kt_N_per_m": 2.1e9,
            "kn_exponent": 0.6,
            "kt_exponent": 0.5,
            "reclamping_scatter": 0.03,
        },
        "friction": {
            "coefficient": 0.42,
            "edge_pressure": 0.02,
            "spread": 0.4,
            "reclamping_scatter": 0.05,
        },
        "damping": {
            "loss_factor": {"1B": 0.02, "2B": 0.02},
            "other_loss_factor": 0.01,
            "reclamping_scatter": 0.03,
        },
        "gauge": {"piston_area_cm2": 17.9, "gain": 1.006, "resolution_bar": 1},
        "tip": {
            "x_mm": {"1B": 3, "2B": 20},
            "preload_over_sine": 1.3,
            "least_preload_N": 0.5,
            "knock_N": 3,
            "newton_per_ampere": {"1B": 0.5, "2B": 2.0},
        },
        "laser": {
            "x_mm": {"1B": 1, "2B": -70},
            "noise_m_per_s": 8e-6,
            "drift_m_per_s": 4e-6,
            "full_scale_m_per_s": 0.1,
        },
        "recording": {
            "sampling_Hz": 51200,
            "substeps": 2,
            "quiet_s": 0.01,
            "push_s": 0.02,
            "drive_time_constants": 3,
            "decay_time_constants": 8,
            "back_s": 0.03,
        },
        "programme": {
            "pressure_bar": [10, 134],
            "drive_A": {"1B": [[2.2, 3.1], [1.0]], "2B": [[2.2], [1.0, 2.0]]},
            "record_interval_s": 180,
            "hold_interval_s": 900,
        },
    }
    for section, change in changes.items():
        bench[section] = {**bench[section], **change} if isinstance(change, dict) else change
    return bench


ROW = {"record": "r001", "mode": "1B", "hold": "h01", "pressure_bar": 20, "drive_A": 3.0}


def _flanks(across: int, wide: int):
    half = np.sqrt(0.5)
    frames, position, flank = [], [], []
    for number, (side, top) in enumerate([(-1, -1), (-1, 1), (1, -1), (1, 1)]):
        normal = np.array([side * half, 0, top * half])
        slope = np.array([side * half, 0, -top * half])
        frames.append([normal, [0, 1, 0], slope])
        centre = np.array([side * LENGTH / 2, 0, top * 0.0075])
        for y in np.linspace(-1, 1, wide):
            for s in np.linspace(-1, 1, across):
                position.append(centre + [0, y * WIDTH / 2, 0] + s * 0.00125 * slope)
                flank.append(number)
    weight = np.ones(len(flank)) * WIDTH * 0.0025 / (across * wide)
    return np.array(frames), np.array(position), np.array(flank), weight


def _element(h: float):
    """Bernoulli beam element for (w, slope) at both ends: k/EI, m/(rho A), geometric per newton."""
    k = np.array(
        [
            [12, 6 * h, -12, 6 * h],
            [6 * h, 4 * h**2, -6 * h, 2 * h**2],
            [-12, -6 * h, 12, -6 * h],
            [6 * h, 2 * h**2, -6 * h, 4 * h**2],
        ]
    )
    m = np.array(
        [
            [156, 22 * h, 54, -13 * h],
            [22 * h, 4 * h**2, 13 * h, -3 * h**2],
            [54, 13 * h, 156, -22 * h],
            [-13 * h, -3 * h**2, -22 * h, 4 * h**2],
        ]
    )
    g = np.array(
        [
            [36, 3 * h, -36, 3 * h],
            [3 * h, 4 * h**2, -3 * h, -(h**2)],
            [-36, -3 * h, 36, -3 * h],
            [3 * h, -(h**2), -3 * h, 4 * h**2],
        ]
    )
    return k / h**3, m * h / 420, g / (30 * h)
