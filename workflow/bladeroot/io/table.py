"""A table of simulated frequencies, checked whole: the user's own simulation as a CSV file.

Columns: mode, load (in the unit of campaign.yaml, or force_N, torque_Nm...; none where the campaign
has no load), frequency_Hz; optionally loss_factor, amplitude_m (or _mm, _um) and derivatives of
ln f by named parameters, each a column by_<name>.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from bladeroot.io.cells import Cells
from bladeroot.io.load import COLUMNS, Load
from bladeroot.io.sheet import read_sheet
from bladeroot.terms import CONTACT

AMPLITUDES = {"amplitude_m": 1.0, "amplitude_mm": 1e-3, "amplitude_um": 1e-6}
_KNOWN_COLUMNS = ("mode", *COLUMNS, "frequency_Hz", "loss_factor", *AMPLITUDES)
BY = "by_"
# A share k phi'Kc phi / omega^2 of a mode's stiffness moves ln f by half of itself (5.16, in log
# k), and all shares make 1.
_LARGEST_DERIVATIVE = 0.5  # of ln f by ln k
_DERIVATIVE_ROUNDING = 5e-3  # of a derivative that is a difference between two simulations


def read_table(path: Path, description: dict, load: Load | None) -> pd.DataFrame:
    """Columns mode, load, frequency_Hz and, where given, loss_factor, amplitude_m and by_<name>.

    The file's name is `attrs["name"]`.

    Raises:
        ValueError: a line for every fault.
    """
    header = _header(path)
    own = tuple(name for name in header if name.startswith(BY) and len(name) > len(BY))
    rows, faults = read_sheet(path, (*_KNOWN_COLUMNS, *own), (*_KNOWN_COLUMNS[1:], *own))
    cells = Cells(path.parent, path, description, load, faults, [])
    if not cells.required(rows, ("mode", "frequency_Hz")):
        raise ValueError("\n".join(faults))
    amplitude = [name for name in AMPLITUDES if name in header]
    if len(amplitude) > 1:
        cells.fault(f"expected one amplitude, got {' and '.join(amplitude)}", 1)
    made, first = [], {}
    for row, values in rows:
        line = {"mode": cells.mode(row, values), "load": cells.load_value(row, values, read=False)}
        line["frequency_Hz"] = cells.number(row, values, "frequency_Hz", positive=True)
        if "loss_factor" in header:
            line["loss_factor"] = cells.number(row, values, "loss_factor", positive=True)
        for name in amplitude:
            value = cells.number(row, values, name, positive=True)
            line["amplitude_m"] = None if value is None else value * AMPLITUDES[name]
        for name in own:
            line[name] = cells.number(row, values, name)
        _shares(cells, row, line)
        place = (line["mode"], line["load"], line.get("amplitude_m"))
        if None not in place[:2]:  # nor is a row that has a fault another one's double
            cells.once(row, place, first, "the combination of mode, load and amplitude")
        made.append(line)
    if not made:
        faults.append(f"no usable row ({path})")
    if faults:
        raise ValueError("\n".join(faults))
    frame = pd.DataFrame(made)
    _whole(frame, path)
    frame.attrs["name"] = path.name
    return frame


def outside(
    table: pd.DataFrame, modes: list[str], loads: list[float], load: Load | None
) -> list[tuple[int, str]]:
    """Number of each record that the table cannot speak of, and why, the same words for all that
    lie outside one range; modes, loads: by record.
    """
    spans = table.groupby("mode")["load"].agg(["min", "max"])
    unit = load.unit if load else ""
    found, beyond = [], {}
    for k, (mode, value) in enumerate(zip(modes, loads, strict=True)):
        if mode not in spans.index:
            known = ", ".join(spans.index)
            found.append((k, f"the table has no mode {mode}; expected one of {known}"))
            continue
        low, high = spans.loc[mode]
        if not low <= value <= high:
            beyond.setdefault((low, high), []).append((k, mode, value))
    for (low, high), some in beyond.items():
        numbers, names, values = zip(*some, strict=True)
        names, values = list(dict.fromkeys(names)), sorted(set(values))
        text = (
            f"{', '.join(f'{value:g}' for value in values)} {unit} "
            f"{'lies' if len(values) == 1 else 'lie'} outside the table's loads of "
            f"mode{'s' * (len(names) > 1)} {', '.join(names)}, {low:g} to {high:g} {unit}"
        )
        found += [(k, text) for k in numbers]
    return sorted(found)


def _header(path: Path) -> list[str]:
    """The column names as far as a first look tells; what is wrong with them `read_sheet` says."""
    first = path.read_bytes()[:4096].decode("utf-8-sig", errors="replace").splitlines()[:1]
    line = first[0] if first else ""
    return [
        name.strip().strip('"') for name in line.replace(";", ",").replace("\t", ",").split(",")
    ]


def _shares(cells: Cells, row: int, line: dict) -> None:
    """Contact carries no less than nothing of a mode's stiffness and no more than all."""
    given = {name: line[name] for name in CONTACT if line.get(name) is not None}
    least, whole = min(given.values(), default=0.0), sum(given.values())
    if least < -_DERIVATIVE_ROUNDING or whole > _LARGEST_DERIVATIVE + _DERIVATIVE_ROUNDING:
        said = " and ".join(f"{name} {value:g}" for name, value in given.items())
        cells.fault(
            "derivatives of ln f by ln kn and ln kt must lie between 0 and "
            f"{_LARGEST_DERIVATIVE:g}, as must their sum, got {said}: in Hz, per cent or by k "
            "itself?",
            row,
        )


def _whole(frame: pd.DataFrame, path: Path) -> None:
    """Every mode and load has the same amplitudes: curves are compared with the smallest one."""
    if "amplitude_m" not in frame:
        return
    every = np.unique(frame["amplitude_m"])
    for (mode, value), here in frame.groupby(["mode", "load"]):
        if here["amplitude_m"].nunique() != every.size:
            raise ValueError(
                f"mode {mode} at load {value:g} has {here['amplitude_m'].nunique()} of the table's "
                f"{every.size} amplitudes; expected all at every load ({path})"
            )
