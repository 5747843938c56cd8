"""An event as a campaign's folder: raw files, records.csv and campaign.yaml."""

from pathlib import Path

import xarray as xr
import yaml

from .event import Event

UNITS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s^2"}


def raw_file(event: Event, sensor: int, folder: Path) -> Path:
    """NetCDF or text, by the seed; text has enough digits for the digitiser's steps."""
    one = event.sensors[sensor]
    quantity, unit = one.chain.quantity, UNITS[one.chain.quantity]
    if (event.seed + sensor) % 4:
        path = folder / f"s{sensor + 1}.nc"
        xr.Dataset(
            {quantity: ("sample", one.samples, {"units": unit})},
            attrs={"sampling_Hz": event.sampling_Hz},
        ).to_netcdf(path)
        return path
    path = folder / f"s{sensor + 1}.csv"
    lines = [f"# sampling_Hz: {event.sampling_Hz!r}", f"{quantity}_{unit}"]
    path.write_text("\n".join([*lines, *(f"{x:.10g}" for x in one.samples)]) + "\n")
    return path


def facts(event: Event, mode: int, sensor: int) -> dict:
    """What the workflow knows of a record besides its samples, as its first stage takes it."""
    names = {k: f"m{k + 1}" for k in event.expected_Hz}
    others = [f for k, f in event.expected_Hz.items() if k != mode]
    chain = event.sensors[sensor].chain
    return {
        "record": f"e{event.seed}-m{mode + 1}-s{sensor + 1}", "mode": names[mode],
        "expected_Hz": event.expected_Hz[mode], "other_modes_Hz": others, "force_N": 10000.0,
        "hold": "", "direction": "", "simulated": False, "quantity": chain.quantity,
        "unit": UNITS[chain.quantity], "channel": None, "sampling_Hz": None, "sensitivity": None,
        "event": f"e{event.seed}", "sensor": f"s{sensor + 1}",
    }  # fmt: skip


def campaign(event: Event, folder: Path) -> list[dict]:
    """Write the campaign into a folder.

    Returns:
        one entry per pair asked for: `raw` (path), `facts`, `mode` and `sensor`.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    modes = {f"m{k + 1}": {"expected_Hz": f, "laser_x_mm": 0} for k, f in event.expected_Hz.items()}
    files = {s: raw_file(event, s, folder) for s in sorted({s for _, s in event.asked})}
    description = {
        "title": f"drawn event {event.seed}",
        "modes": modes,
        "force": {
            "gauge": "pressure", "piston_area_cm2": 17.9, "full_scale_bar": 700,
            "accuracy_percent": 1, "accuracy_of": "full-scale",
        },
    }  # fmt: skip
    (folder / "campaign.yaml").write_text(yaml.safe_dump(description, sort_keys=False))
    entries, rows = [], ["record,file,mode,force_N,quantity,unit,event,sensor"]
    for mode, sensor in event.asked:
        known = facts(event, mode, sensor)
        columns = ("mode", "force_N", "quantity", "unit", "event", "sensor")
        rows.append(
            ",".join([known["record"], files[sensor].name, *(str(known[c]) for c in columns)])
        )
        entries.append({"raw": files[sensor], "facts": known, "mode": mode, "sensor": sensor})
    (folder / "records.csv").write_text("\n".join(rows) + "\n")
    return entries
