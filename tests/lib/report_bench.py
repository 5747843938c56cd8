"""Verdicts, diagnoses and mean curves as the report reads them."""

import numpy as np
import xarray as xr

POWER, SEATING = "load-dependent-stiffness", "incomplete-contact"


def cause(credible=(POWER,), **more):
    return {
        "mechanism": credible[0], "class": "force-law", "credible_set": list(credible),
        "parameters": [{"name": "exponent", "value": 0.6, "std": 0.08, "unit": "1"}],
        "plausible": True, "splitter": "twice the force", "log_evidence": 20.0,
        "form": "power", "probability": 0.97 if len(credible) == 1 else 0.7, "sizes": [],
        "shown": True, **more,
    }  # fmt: skip


def verdict(answer="named", causes=(), **more):
    trend = "rises with the force by {} % more than simulated"
    missing = answer not in ("nothing-missing", "insufficient-data")
    sides = {"before": 4e-3, "after": 1e-3, "unit": "1"}
    gain = {"between_forces": {**sides, "by_mode": {"1B": sides}},
            "log_score": {"before": 10.0, "after": 31.0}}  # fmt: skip
    return {
        "structure": "S", "answer": answer, "causes": list(causes), "records": {},
        "probabilities": {POWER: 0.97, "none": 0.03} if causes else {"none": 0.995, POWER: 0.005},
        "shortfall": [
            {"quantity": "stick frequency", "mode": mode, "trend": trend.format(number),
             "size": number / 100, "explained": bool(causes)}
            for mode, number in (("1B", 0.6), ("2B", 0.4))
        ] if missing else [],
        "gain": gain if causes else {}, "reason": "why", **more,
    }  # fmt: skip


def found(named=POWER, barred="", lacks="", holds=True, curves=True, rivals=f"{POWER};{SEATING}"):
    """A diagnosis of eight records in two modes, with two candidates and a smooth one."""
    n, rng = 8, np.random.default_rng(1)
    force = np.repeat([4e3, 8e3, 12e3, 20e3], 2)
    left = np.stack([np.linspace(-12, 12, n), rng.standard_normal(n)])
    made = xr.Dataset(
        {
            "class": ("candidate", ["force-law", "force-law", "smooth"]),
            "channel": ("candidate", ["stick"] * 3),
            "log_evidence": ("candidate", [20.0, 18.0, 5.0]),
            "is_named": ("candidate", np.array([int(bool(named)), 0, 0], dtype=np.int8)),
            "barred": ("candidate", ["", barred, "no mechanism"]),
            "sentence": ("candidate", ["it stiffens", "it seats", "any"]),
            "stick_mode": ("stick_record", ["1B", "2B"] * 4),
            "stick_force": ("stick_record", force),
            "stick_time": ("stick_record", np.arange(n) * 600.0 if holds else np.zeros(n)),
            "stick_direction": ("stick_record", np.repeat([1.0, -1.0], 4) * holds),
            "stick_hold": ("stick_record", np.arange(n) // 2 if holds else np.arange(n)),
            "stick_frequency": ("stick_record", 500.0 + force / 1e3),
            "stick_simulated": (("stage", "stick_record"), 500.0 + np.stack([force, force]) / 1e3),
            "stick_residual": (("stage", "stick_record"), 1e-3 * left),
            "stick_residual_scaled": (("stage", "stick_record"), left),
            "law_k": (("stage", "stiffness", "law_force"), np.full((2, 2, 3), 1e9)),
            "law_ln_std": (("stage", "stiffness", "law_force"), np.full((2, 2, 3), 0.3)),
            "law_correlation": (("stage", "law_force"), np.full((2, 3), -0.9)),
            "decided": ("option", [0.0, 0.2, 0.7], {"rivals": rivals}),
            "hours": ("option", [np.nan, 2.0, 2.0]),
            "size_std": ("option", [1.0, 0.8, 0.9]),
            "expected_ln_std": (("option", "stiffness"), [[0.5, 0.6], [0.4, 0.5], [0.45, 0.5]]),
        },
        coords={
            "candidate": [POWER, SEATING, "smooth in force"], "stage": ["before", "after"],
            "stick_record": [f"r{k}" for k in range(n)], "mode": ["1B", "2B"],
            "law_force": [4e3, 12e3, 20e3], "stiffness": ["kn", "kt"],
            "option": ["as measured", "more of the same", "another force"],
        },
        attrs={"structure": "S", "named": named, "lacks": lacks},
    )  # fmt: skip
    if curves:
        made = made.merge(_curves())
    return made


def _curves():
    amplitude = np.tile(np.logspace(-8, -5, 6), 4)
    mode, force = np.repeat(["1B", "2B"], 12), np.tile(np.repeat([4e3, 20e3], 6), 2)
    entries = {"curve_mode": ("point", mode), "curve_force": ("point", force),
               "curve_amplitude": ("point", amplitude)}  # fmt: skip
    for name in ("curve_frequency", "curve_loss"):
        entries[name] = ("point", 100.0 * amplitude)
        entries[f"{name}_std"] = ("point", np.full(24, 1e-5))
        entries[f"{name}_simulated"] = (("stage", "point"), np.zeros((2, 24)))
    return xr.Dataset(entries)


def curves(forces=(4000.0, 8000.0)):
    """Mean curves that soften by one percent of the logarithm, known at every amplitude."""
    amplitude = np.geomspace(1e-8, 1e-5, 61)
    frequency = 480.0 + 1e-3 * np.array(forces)[:, None] - 0.5 * np.log(amplitude / 1e-8)
    values = {"frequency": frequency, "loss_factor": 1e-5 * frequency}
    values |= {f"{name}_{kind}": 1e-4 * value for name, value in values.items()
               for kind in ("std", "change_std")}  # fmt: skip
    values |= {f"{name}_scatter": 1e-3 * values[name] for name in ("frequency", "loss_factor")}
    made = {name: (("level", "amplitude"), value) for name, value in values.items()}
    made["records"] = (("level", "amplitude"), np.full(frequency.shape, 4))
    made |= {"mode": ("level", ["1B"] * len(forces)), "force": ("level", list(forces))}
    return xr.Dataset(made, coords={"amplitude": amplitude}, attrs={"simulated": 0})
