"""A whole campaign in one process: the workflow's stages from its folder to its verdict."""

import tempfile
import textwrap
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pandas as pd
import xarray as xr

from bladeroot.io.campaign import Campaign, load_campaign
from bladeroot.io.facts import diagnosis_facts, observation_facts, record_facts
from bladeroot.io.load import load_facts
from bladeroot.io.stick_rows import stick_table
from bladeroot.schema import check, read_yaml
from bladeroot.shipped_files import shipped, structure_file

# A structure's name to its reduced matrices.
Reduced = Callable[[str], xr.Dataset]


@dataclass(frozen=True)
class Verdict:
    """What the simulation of a campaign gets wrong, and why.

    said: the fields of `verdict.json`. diagnosis, observations: what was compared, and the records
    as they were taken. stick: stick frequencies of records and of levels of load. curves: by
    record, over amplitude; empty where the campaign is a table of stick frequencies.
    """

    said: dict
    diagnosis: xr.Dataset
    observations: xr.Dataset
    stick: xr.Dataset
    curves: Mapping[str, xr.Dataset]

    @property
    def answer(self) -> str:
        """named, ambiguous, unexplained, nothing-missing or insufficient-data."""
        return self.said["answer"]

    @property
    def probabilities(self) -> dict[str, float]:
        """Of sets of causes, of none and of something of no catalogue."""
        return self.said["probabilities"]

    @property
    def causes(self) -> tuple[str, ...]:
        """Ids of the causes that are named, or without a name those that the data show.

        What explains most comes first; what may act beside them stands in `said`.
        """
        shown = [one for one in self.said["causes"] if one["shown"]]
        if self.answer == "named":
            shown = [one for one in shown if len(one["credible_set"]) == 1]
        return tuple(one["mechanism"] for one in shown)

    def plot(self):
        """Measured stick frequencies and loss factors over the load, by mode.

        Returns:
            a Figure, none of pyplot's: `verdict.plot().savefig("a.png")` saves it.
        """
        from bladeroot.figures.stick import over_load
        from bladeroot.figures.still import still

        drawn = over_load(self.stick, None, bool(self.stick.attrs["simulated"]))
        if drawn is None:
            raise ValueError(
                "no record reached its plateau: there are no stick frequencies to plot"
            )
        return still(drawn)

    def __repr__(self) -> str:
        """The answer, its reason, and what is most probable."""
        share = {one["mechanism"]: one["probability"] for one in self.said["causes"]}
        named = [(name, share[name]) for name in self.causes]
        best = sorted(self.probabilities.items(), key=lambda pair: -pair[1])[:3]
        lines = [f"{self.said['campaign']}: {self.answer}", _filled(self.said["reason"])]
        bad = self.observations["record"].values[self.observations["verdict"].values == "rejected"]
        if bad.size:
            whole = self.observations.sizes["record"]
            lines += [_filled(f"without {bad.size} of {whole} records: {', '.join(bad)}")]
        return "\n".join([*lines, *(f"  {_chance(p)}  {names}" for names, p in named or best)])


def _filled(text: str) -> str:
    return textwrap.fill(text, 88, initial_indent="  ", subsequent_indent="  ")


def _chance(probability: float) -> str:
    """In per cent, never as certain as it cannot be."""
    return f"{probability:6.1%}" if probability <= 0.99 else " > 99%"


def diagnose(campaign: str | Path, config: str | Path | Mapping | None = None) -> Verdict:
    """What the simulation of a campaign gets wrong, by the workflow's stages without the workflow.

    Args:
        campaign: its folder (campaign.yaml, and records.csv or stick.csv).
        config: settings as of `config/config.yaml`, a file or its content; without, the shipped
            ones.

    The simulation is the campaign's first structure, its table, or linear modes. Nothing is
    written. A structure takes some twenty seconds, a record about a tenth of a second, a record
    that the virtual bench makes first one or two.

    What is odd in the sheet and may be meant is a warning, a line each.

    Raises:
        ValueError: what is wrong in the campaign's files or the settings, a line each.

    >>> import bladeroot as br
    >>> verdict = br.diagnose("two-modes")  # a folder with campaign.yaml and records.csv
    >>> verdict.answer, verdict.causes
    ('nothing-missing', ())
    """
    from bladeroot.diagnosis.judged import judge
    from bladeroot.diagnosis.observations import observations
    from bladeroot.mechanisms.catalogue import usable_catalogue
    from bladeroot.pooling.judgement import judgement
    from bladeroot.pooling.stick import stick_from_records
    from bladeroot.pooling.stick_table import stick_from_table
    from bladeroot.rom.whole import reduced_structure

    if not isinstance(campaign, str | Path):
        raise ValueError(f"campaign must be a folder, got a {type(campaign).__name__}")
    described, asked = load_campaign(campaign), _config(config)
    for line in described.warnings:
        warnings.warn(line, stacklevel=2)
    reduced = cache(lambda name: reduced_structure(structure_file(name, described.folder)))
    own = {"campaign": described.name, "simulated": int(described.simulated)}
    analysed = list(_analysed(described, asked, reduced))
    records, curves, plateaus = zip(*analysed, strict=True) if analysed else ((), (), ())
    if curves:
        stick = stick_from_records(plateaus)
    else:
        load = described.load
        table = stick_table(described.folder / "stick.csv", load)
        stick = stick_from_table(table, asked["stick"]["table_error"], load_facts(load))
    integrity = judgement(records, curves, plateaus) if curves else None
    seen = observations(stick.assign_attrs(own), curves, integrity, observation_facts(described))
    seen = seen.assign_attrs(own)
    facts = diagnosis_facts(described, asked)
    candidates, failed = usable_catalogue(facts["mechanisms"] or None)
    whole, said, _ = judge(seen, _simulation(described, asked, reduced), facts, candidates)
    whole = whole.assign_attrs(own, mechanisms_not_tried="; ".join(failed))
    by_record = {str(one.attrs["record"]): one for one in curves}
    return Verdict(said, whole, seen, stick.assign_attrs(own), by_record)


def structures_of(campaign: Campaign) -> dict[str, Path]:
    """Files of a campaign's structures by name, checked; ValueError with a line a fault."""
    from bladeroot.rom.file import named_structure

    described = campaign.description
    loads = [row["load"] for row in campaign.records or campaign.stick]
    return {
        name: named_structure(name, campaign.folder, described["modes"], loads)
        for name in described["structure"]
    }


def faults_of_matrices(campaign: Campaign) -> list[str]:
    """What is wrong in the matrices of a campaign's structures, a line a fault.

    Raises ValueError with a line a fault for what is wrong in the structures' files and tables.
    """
    from bladeroot.rom.whole import check_matrices

    faults = []
    for path in structures_of(campaign).values():
        try:
            check_matrices(path)
        except ValueError as error:
            faults += str(error).splitlines()
    return faults


def _config(given: str | Path | Mapping | None) -> dict:
    if isinstance(given, Mapping):
        check(dict(given), "config", "config")
        return dict(given)
    return read_yaml(given or shipped("config/config.yaml"), "config")


def _analysed(
    campaign: Campaign, config: Mapping, reduced: Reduced
) -> Iterator[tuple[xr.Dataset, ...]]:
    """Free decay, curves and plateau of each record, in the order of names."""
    from bladeroot.decay.from_file import from_file
    from bladeroot.reproduction.thesis_filters import estimation

    settings = config["record"], estimation(config["decay"])
    with tempfile.TemporaryDirectory() as made:
        for row in sorted(campaign.records, key=lambda row: row["record"]):
            raw = row["file"]
            if campaign.simulated:
                raw = _simulated(campaign, row, reduced, Path(made))
            facts = record_facts(campaign, row)
            yield from_file(campaign.folder / raw, facts, *settings)


def _simulated(campaign: Campaign, row: Mapping, reduced: Reduced, folder: Path) -> Path:
    """The raw file of a record that the virtual bench makes; its truth is not kept."""
    from bladeroot import artifacts
    from bladeroot.bench.bench import simulate
    from bladeroot.bench.joint import parts

    described = read_yaml(campaign.folder / campaign.description["bench"], "bench")
    record, _ = simulate(described, parts(reduced(described["structure"])), row)
    artifacts.save(record, folder / f"{row['record']}.nc")
    return folder / f"{row['record']}.nc"


def _simulation(
    campaign: Campaign, config: Mapping, reduced: Reduced
) -> xr.Dataset | pd.DataFrame | None:
    """What `bladeroot.diagnosis.judged.judge` compares with."""
    from bladeroot.io.table import read_table
    from bladeroot.rom.whole import parametric_structure

    asked = campaign.description["simulation"]
    if structures := structures_of(campaign):
        return parametric_structure(reduced(next(iter(structures))), config["parametric"])
    if asked == "none":
        return None
    return read_table(campaign.folder / asked, campaign.description, campaign.load)
