"""Small campaigns drawn from the parametric model itself, with one effect put in."""

import numpy as np
import xarray as xr
from bladeroot.diagnosis.simulation.parametric import of_structure
from bladeroot.rom.parametric import frequencies, surface_of

FORCES = 179.0 * np.array([10, 20, 30, 43, 67, 100, 134])
MODES = ("1B", "2B")
NOISE = 3e-6  # of a frequency, between records of one hold
INTERVAL, HOLD = 180.0, 900.0  # s between records, and more between holds


def simulated(seen, model, bias=0.005):
    """What the diagnosis is told of a structure's model: its measured modes, known to a part."""
    modes = seen["mode"].values.astype(str)
    return of_structure(model, modes, dict.fromkeys(("1B", "2B"), bias), {})


def programme(cycles=2, records=2, forces=FORCES, modes=MODES):
    """Rows (mode, force, hold, direction, time), up and down, both modes in each hold."""
    rows, time, hold = [], 0.0, 0
    for _ in range(cycles):
        for direction, order in (("up", forces), ("down", forces[::-1])):
            for force in order:
                hold += 1
                for mode in modes:
                    for _ in range(records):
                        rows.append((mode, force, f"h{hold:02d}", direction, time))
                        time += INTERVAL
                time += HOLD
    return rows


def campaign(model, effect="", size=0.0, seed=0, scatter=0.04, rows=None, curves=True):
    """Observations of a simulated campaign.

    model: parametric model of the structure. effect: `gain`, `offset` (N), `exponent`, `seating`
    (N), `hysteresis`, `drift`, `spell` (of kn, kt while the second series lasts), `relaxation`,
    `mass` (relative change of 1B), `bump` (of 2B about 8 kN), or on the curves `slip`, `hardening`,
    `drag`, `knee`; "" for none.
    """
    rng = np.random.default_rng(seed)
    rows = programme() if rows is None else rows
    mode = np.array([MODES.index(row[0]) for row in rows])
    force = np.array([row[1] for row in rows])
    time = np.array([row[4] for row in rows])
    names, hold = np.unique([row[2] for row in rows], return_inverse=True)
    sign = np.where([row[3] == "up" for row in rows], 1.0, -1.0)
    since = time - np.array([time[hold == h].min() for h in hold])
    true = force + rng.uniform(-89.5, 89.5, names.size)[hold]
    ln_k = np.log(np.exp(rng.normal(np.log(1.5e9), 0.25, 2)))
    ln_k = ln_k + scatter * rng.standard_normal((names.size, 2))[hold]
    direct = rng.normal(0.0, 0.003, 2)[mode]
    if effect == "gain":
        true = true * (1.0 + size)
    elif effect == "offset":
        true = true + size
    elif effect == "exponent":
        ln_k = ln_k + size * np.log(true / 12e3)[:, None]
    elif effect == "seating":
        ln_k = ln_k + np.log(np.minimum(1.0, true / size))[:, None]
    elif effect == "hysteresis":
        ln_k = ln_k - size * (sign[:, None] > 0)
    elif effect == "drift":
        direct = direct - size * time / time.max()
    elif effect == "spell":
        series = np.concatenate([[0], np.cumsum(np.diff(sign) != 0.0)])
        ln_k = ln_k - size * (series == 1)[:, None]
    elif effect == "relaxation":
        true = true * (1.0 - size * (1.0 - np.exp(-since / 300.0)))
    elif effect == "mass":
        direct = direct - size * (mode == 0)
    elif effect == "bump":
        direct = direct + size * (mode == 1) * np.exp(-0.5 * (np.log(true / 8e3) / 0.4) ** 2)
    points = np.column_stack([ln_k, true])
    f = frequencies(surface_of(model.sel(mode=list(MODES))), points)[np.arange(mode.size), mode]
    f = f * np.exp(direct + NOISE * rng.standard_normal(mode.size))
    eta = np.array([0.0024, 0.0045])[mode] * np.exp(0.03 * rng.standard_normal(names.size)[hold])
    amplitude = 10.0 ** (np.arange(-8 * 14, -4.7 * 14) / 14.0) if curves else np.zeros(0)
    curve = _curves(rng, effect, size, mode, true, amplitude)
    values = {
        "mode": [row[0] for row in rows], "force": force, "hold": [row[2] for row in rows],
        "direction": [row[3] for row in rows], "time": time, "stick_frequency": f,
        "stick_frequency_std": 5e-7 * f, "stick_loss_factor": eta,
        "stick_loss_factor_std": 2e-3 * eta, "onset_amplitude": np.full(mode.size, np.nan),
        "plateau_reached": np.ones(mode.size, dtype=int), "findings": [""] * mode.size,
        "verdict": ["usable"] * mode.size, "correlation_decades": np.full(mode.size, 1.0),
    }  # fmt: skip
    made = {name: ("record", np.array(value)) for name, value in values.items()}
    shape = ("record", "amplitude")
    made |= {
        "frequency": (shape, f[:, None] * np.exp(curve[0])),
        "loss_factor": (shape, eta[:, None] + curve[1]),
        "frequency_std": (shape, f[:, None] * curve[2]), "loss_factor_std": (shape, curve[3]),
        "laser_x_m": ("sensor_mode", [0.0, -0.07]),
    }  # fmt: skip
    return xr.Dataset(
        made,
        coords={"record": [f"r{i:03d}" for i in range(mode.size)], "amplitude": amplitude,
                "sensor_mode": list(MODES)},
        attrs={"simulated": 1, "campaign": "drawn", "gauge_full_scale_std_N": 1253.0,
               "gauge_relative_std": 0.01, "gauge_resolution_N": 179.0},
    )  # fmt: skip


def _curves(rng, effect, size, mode, force, amplitude):
    """Changes of ln f and of the loss factor with their correlated errors, and those errors."""
    a, m = amplitude[None, :], mode[:, None]
    ln_f, loss = np.zeros((mode.size, amplitude.size)), np.zeros((mode.size, amplitude.size))
    top = rng.uniform(4e-6, 1.5e-5, mode.size)[:, None] * np.where(m == 1, 0.5, 1.0)
    if effect == "slip":
        ratio = a / (np.where(m == 1, 0.5, 1.0) * 3e-10 * force[:, None])
        past = np.maximum(ratio - 1.0, 0.0) / ratio**2
        loss = loss + size * 16.0 / np.pi * past
        angle = np.arccos(1.0 - 2.0 * np.minimum(1.0 / ratio, 1.0))
        ln_f = ln_f - 2.0 * size * (1.0 - (angle - 0.5 * np.sin(2.0 * angle)) / np.pi)
    elif effect == "hardening":
        ln_f = ln_f + size * a**2
    elif effect == "drag":
        loss = loss + size * a
    elif effect == "knee":
        loss = loss + size * np.exp(-0.5 * np.log(a / 1e-6) ** 2)
    std_f, std_loss = 3e-6 * np.sqrt(1e-6 / a), 5e-6 * np.sqrt(1e-6 / a)
    std_f, std_loss = (np.broadcast_to(part, ln_f.shape) for part in (std_f, std_loss))
    if amplitude.size:
        distance = np.abs(np.log(amplitude)[:, None] - np.log(amplitude))
        root = np.linalg.cholesky(np.exp(-distance) + 1e-9 * np.eye(amplitude.size))
        ln_f = ln_f + std_f * (rng.standard_normal(ln_f.shape) @ root.T)
        loss = loss + std_loss * (rng.standard_normal(ln_f.shape) @ root.T)
    gone = a > top
    return (
        *(np.where(gone, np.nan, part) for part in (ln_f, loss)),
        *(np.where(gone, np.nan, part) for part in (std_f, std_loss)),
    )
