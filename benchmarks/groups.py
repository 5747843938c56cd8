"""Pooling with groups and events: do errors cover, and are groups told apart, on drawn campaigns?

    python benchmarks/groups.py [campaigns] [first seed]           # three minutes for 200

Each campaign has three groups of three to six events that three sensors see. ln frequency and ln
loss factor of an event have a curve that all share, a level of its group, a scatter of its own, and
at each sensor an error that is stated. Scatter between events is 1 to 30 times the stated error,
groups differ by 0, 1 or 5 times that scatter. Scored are the mean of each group, as stick
frequency and as a curve, its level against the mean of the groups, the difference between the
outermost groups where they are said to differ, and how often they are.
"""

import sys

import numpy as np
import xarray as xr
from bladeroot.plateau.plateau import RECORD_VARIABLES
from bladeroot.pooling.curves import mean_curves
from bladeroot.pooling.groups import group_differences
from bladeroot.pooling.stick import stick_from_records

GROUPS, SENSORS = ("a", "b", "c"), ("x", "y", "z")
APART = (0.0, 1.0, 5.0)  # standard deviation of the groups' levels, in that of the events
AMPLITUDE = np.geomspace(1e-4, 1e-6, 60)
LOSS = 1e-2  # loss factor in the middle; scatters of it are this many times those of frequency
MORE = 30.0


def campaign(rng: np.random.Generator, apart: float) -> tuple[list, list, np.ndarray]:
    """Decays and plateaus of all records, and ln frequency of the groups."""
    own = 10 ** rng.uniform(-6.0, -4.5)
    scatter = own * 10 ** rng.uniform(0.0, 1.5)
    levels = apart * scatter * rng.standard_normal(len(GROUPS))
    decays, plateaus = [], []
    for group, level in zip(GROUPS, levels, strict=True):
        for event in range(rng.integers(3, 7)):
            moved = level + scatter * rng.standard_normal()
            for sensor in SENSORS:
                seen = moved + own * rng.standard_normal()
                facts = {"mode": "m", "load": 0.0, "load_name": "", "load_unit": "",
                         "group": group, "event": f"{group}{event}", "sensor": sensor,
                         "record": f"{group}{event}{sensor}"}  # fmt: skip
                decays.append(decay(seen, own, facts))
                plateaus.append(plateau(seen, own, facts))
    return decays, plateaus, levels


def decay(level: float, own: float, facts: dict) -> xr.Dataset:
    """A curve that softens by 1 % a decade, with its stated errors."""
    fall = np.log10(AMPLITUDE / AMPLITUDE[-1])
    frequency, loss = 100.0 * np.exp(level - 0.01 * fall), LOSS * np.exp(MORE * level + 0.1 * fall)
    made = {"amplitude": AMPLITUDE, "frequency": frequency, "loss_factor": loss}
    made |= {"frequency_std": own * frequency, "loss_factor_std": MORE * own * loss}
    return xr.Dataset({name: ("point", value) for name, value in made.items()}, attrs=facts)


def plateau(level: float, own: float, facts: dict) -> xr.Dataset:
    """The same record's stick frequency."""
    made = dict.fromkeys(RECORD_VARIABLES, np.nan) | {"plateau_reached": 1, "verdict": "plateau"}
    made |= {"stick_frequency": 100.0 * np.exp(level), "loss_factor": LOSS * np.exp(MORE * level)}
    made |= {"stick_frequency_std": 100.0 * own, "loss_factor_std": LOSS * MORE * own}
    return xr.Dataset(made, attrs=facts)


def score(seed: int, apart: float) -> dict:
    """Errors over stated ones of a campaign, and whether its groups are said to differ."""
    rng = np.random.default_rng([seed, int(apart)])
    decays, plateaus, levels = campaign(rng, apart)
    stick, curves = stick_from_records(plateaus), mean_curves(decays, plateaus)
    true = 100.0 * np.exp(levels)
    middle = curves.isel(amplitude=curves.sizes["amplitude"] // 2)
    fall = 0.01 * np.log10(float(middle["amplitude"]) / AMPLITUDE[-1])
    of_level = [GROUPS.index(name) for name in middle["group"].values]
    found = group_differences(decays, [False] * len(decays))
    own = found.isel(group_level=found["of_group_quantity"].values == "frequency")
    found = found.isel(comparison=found["compared_quantity"].values == "frequency").squeeze()
    high, low = (GROUPS.index(found[f"{end}_group"].item()) for end in ("high", "low"))
    off = float(found["difference"]) - np.expm1(levels[high] - levels[low])
    told = int(found["told"])
    return {
        "stick": list((stick["frequency"].values - true) / stick["frequency_std"].values),
        "curve": list(
            (middle["frequency"].values / np.exp(-fall) - true[of_level])
            / middle["frequency_std"].values
        ),
        "level": list(
            (own["of_group_level"].values - (levels - levels.mean()))
            / own["of_group_level_std"].values
        ),
        "difference": [off / float(found["difference_std"])] if told else [],
        "told": told,
    }


def main() -> None:
    count, first = ([int(text) for text in sys.argv[1:]] + [200, 430000][len(sys.argv) - 1 :])[:2]
    print("68/95 % hold the truth")
    print("groups apart |     stick     curve     level  difference, where said | said to differ")
    for apart in APART:
        rows = [score(first + k, apart) for k in range(count)]
        cells = []
        for name in ("stick", "curve", "level", "difference"):
            z = np.abs(np.concatenate([row[name] for row in rows]))
            shares = (100.0 * np.mean(z < limit) if z.size else np.nan for limit in (1.0, 1.96))
            cells.append("".join(f"{share:5.0f}" for share in shares))
        told = 100.0 * np.mean([row["told"] for row in rows])
        print(f"{apart:12g} |{cells[0]}{cells[1]}{cells[2]}{cells[3]:>24s} | {told:12.1f} %")


if __name__ == "__main__":
    main()
