"""The product on one campaign in one process: the stages' own scripts' calls, in their order.

This file alone of the laboratory uses the product, through the same functions as
`workflow/scripts` call, with the settings of `config/config.yaml`.
"""

import importlib.util
import json
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

import yaml

ROOT = Path(__file__).resolve().parents[2]
SCRIPTS = ROOT / "workflow" / "scripts"


def stage(name: str) -> Callable:
    """`main` of a stage's script."""
    return _script(name).main


def _script(name: str) -> ModuleType:
    for folder in (ROOT / "workflow", SCRIPTS):
        if str(folder) not in sys.path:
            sys.path.insert(0, str(folder))
    spec = importlib.util.spec_from_file_location(f"_stage_{name}", SCRIPTS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def configuration() -> dict:
    """The shipped settings."""
    return yaml.safe_load((ROOT / "config" / "config.yaml").read_text())


def parametric_of(structure_file: Path, cache: Path) -> Path:
    """`parametric.nc` of a structure of kind `matrices`, from the cache if it is there."""
    folder = cache / "structures" / structure_file.stem
    done = folder / "parametric.nc"
    if not done.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        mesh, reduced = folder / "mesh.nc", folder / "reduced.nc"
        stage("matrices_mesh")(structure_file, mesh)
        stage("matrices_reduced")(structure_file, mesh, reduced)
        stage("parametric")(reduced, "area", json.dumps(configuration()["parametric"]), done)
    return done


@contextmanager
def in_memory(kept: bool) -> Iterator[None]:
    """Artifacts are handed from stage to stage without files, which cost more than the analysis.

    With `kept` they are files as in a run by Snakemake.
    """
    stage("record")  # the library's path
    from bladeroot import artifacts

    shelf, load, save = {}, artifacts.load, artifacts.save

    def shelve(dataset, path, *, origin=None, settings="{}"):
        source = {"campaign": "", "simulated": 0} | (dataset if origin is None else origin).attrs
        shelf[Path(path)] = dataset.assign_attrs(
            campaign=source["campaign"], simulated=source["simulated"], settings=settings
        )

    def fetch(path):
        found = shelf.get(Path(path))
        return load(path) if found is None else found.copy(deep=True)

    if kept:
        yield
        return
    artifacts.load, artifacts.save = fetch, shelve
    try:
        yield
    finally:
        artifacts.load, artifacts.save = load, save


def infer(folder: Path, results: Path, cache: Path, shipped: Path, keep: bool = False) -> dict:
    """verdict.json of a campaign's folder; artifacts of the stages go to `results`, with `keep`.

    `shipped`: `parametric.nc` of the shipped structure, for campaigns that name it. The answer has
    `seconds` beside the verdict: CPU time of the records and of the diagnosis.
    """
    own = folder / f"{yaml.safe_load((folder / 'campaign.yaml').read_text())['structure'][0]}.yaml"
    parametric = parametric_of(own, cache) if own.is_file() else shipped
    with in_memory(keep):
        return _inferred(folder, results, parametric)


def _inferred(folder: Path, results: Path, parametric: Path) -> dict:
    clock = time.process_time()
    from bladeroot.records.campaign import load_campaign

    campaign, config = load_campaign(folder), configuration()
    name = campaign.name
    modes = campaign.description["modes"]
    made: dict[str, list[Path]] = {"records": [], "decay": [], "plateau": []}
    settings = {part: json.dumps(config[part]) for part in ("record", "decay", "stick")}
    for row in campaign.records:
        paths = {part: results / part / f"{row['record']}.nc" for part in made}
        others = [modes[m]["expected_Hz"] for m in modes if m != row["mode"]]
        facts = {**row, **modes[row["mode"]], "other_modes_Hz": others, "simulated": False}
        stage_record, stage_decay = _cached("record"), _cached("decay")
        stage_record(
            folder / row["file"], json.dumps(facts), name, settings["record"], paths["records"]
        )
        stage_decay(paths["records"], settings["decay"], paths["decay"], paths["plateau"])
        for part, path in paths.items():
            made[part].append(path)
    integrity, stick = results / "integrity.nc", results / "stick.nc"
    stage("integrity")(made["records"], made["decay"], made["plateau"], name, integrity)
    stage("stick")(made["plateau"], name, settings["stick"], stick)
    recorded = time.process_time() - clock
    clock = time.process_time()
    seen, verdict = results / "observations.nc", results / "verdict.json"
    stage("observations")(
        stick, made["decay"], [integrity], json.dumps(_observed_facts(campaign)), seen
    )
    stage("diagnosis")(
        seen,
        parametric,
        json.dumps(
            {
                **config["diagnosis"],
                **config["search"],
                "full_contact_from_kN": campaign.description.get("full_contact_from_kN", 0),
                "independent": campaign.description.get("independent", []),
            }
        ),
        results / "diagnosis.nc",
        verdict,
        None,
    )
    diagnosed = time.process_time() - clock
    return {
        **json.loads(verdict.read_text()),
        "seconds": {"records": recorded, "diagnosis": diagnosed},
    }


_MAINS: dict[str, Callable] = {}


def _cached(name: str) -> Callable:
    if name not in _MAINS:
        _MAINS[name] = stage(name)
    return _MAINS[name]


def _observed_facts(campaign) -> dict:
    """As `workflow/rules/diagnosis.smk` gives them."""
    modes, force = campaign.description["modes"], campaign.description["force"]
    return {
        "full_scale": campaign.force_full_scale,
        "scale": campaign.force_scale,
        "accuracy": force["accuracy_percent"] / 100,
        "primary": force["accuracy_of"],
        "laser_x": {mode: 1e-3 * modes[mode]["laser_x_mm"] for mode in modes},
        "time": {r["record"]: r["time_s"] for r in campaign.records if r["time_s"] is not None},
    }
