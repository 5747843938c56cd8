"""The product on one campaign in one process: the stages' own scripts' calls, in their order.

This file alone of the laboratory uses the product, through the same functions as
`workflow/scripts` call, with the settings of `config/config.yaml`.
"""

import hashlib
import importlib.util
import json
import pickle
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

import xarray as xr
import yaml

ROOT = Path(__file__).resolve().parents[2]
SCRIPTS = ROOT / "workflow" / "scripts"
RECORD_STAGES = ("ringdown", "integrity", "stick")


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
        asked = configuration()["parametric"]
        try:
            stage("parametric")(reduced, "area", json.dumps(asked), done)
        except ValueError:
            # 1B and 2B are what is needed; a user leaves out a third mode that crosses another
            fewer = {**asked, "modes": ["1B", "2B"]}
            stage("parametric")(reduced, "area", json.dumps(fewer), done)
    return done


@contextmanager
def in_memory(kept: bool) -> Iterator[dict]:
    """Artifacts are handed from stage to stage without files, which cost more than the analysis.

    With `kept` they are files as in a run by Snakemake, and the shelf that is given stays empty.
    """
    stage("ringdown")  # the library's path
    from bladeroot import artifacts

    shelf, load, save = {}, artifacts.load, artifacts.save

    def shelve(dataset, path, *, origin=None, settings="{}"):
        source = {"campaign": "", "simulated": 0} | (dataset if origin is None else origin).attrs
        shelf[Path(path)] = dataset.assign_attrs(
            campaign=source["campaign"], simulated=source["simulated"], settings=settings
        )

    def fetch(path, without=()):
        found = shelf.get(Path(path))
        if found is None:
            return load(path, without)
        return found.drop_vars(without, errors="ignore").copy(deep=True)

    if kept:
        yield shelf
        return
    artifacts.load, artifacts.save = fetch, shelve
    try:
        yield shelf
    finally:
        artifacts.load, artifacts.save = load, save


def analysed_file(folder: Path, case: str) -> Path:
    """Where the analysed records of a case are kept: another name once any code that made them is.

    The diagnosis alone may change without new records.
    """
    stage("ringdown")  # the library's path
    from bladeroot.provenance import code_hash

    parts = [code_hash(SCRIPTS / f"{name}.py") for name in RECORD_STAGES]
    lab = Path(__file__).parent
    parts += [path.read_text() for path in sorted(lab.rglob("*.py")) if path.name not in _NO_MAKERS]
    key = hashlib.sha256("".join(parts).encode()).hexdigest()
    return folder / f"{case}-{key[:12]}.pickle"


_NO_MAKERS = ("run.py", "score.py")


def infer(
    folder: Path,
    results: Path,
    cache: Path,
    shipped: Path,
    keep: bool = False,
    analysed: Path | None = None,
) -> dict:
    """verdict.json of a campaign's folder; artifacts of the stages go to `results`, with `keep`.

    `shipped`: `parametric.nc` of the shipped structure, for campaigns that name it. `analysed`: the
    analysed records, taken from there if the file exists, else left there. The answer has
    `seconds` beside the verdict: CPU time of the records and of the diagnosis.
    """
    own = folder / f"{yaml.safe_load((folder / 'campaign.yaml').read_text())['structure'][0]}.yaml"
    parametric = parametric_of(own, cache) if own.is_file() else shipped
    with in_memory(keep) as shelf:
        clock = time.process_time()
        if analysed is not None and analysed.is_file():
            stored = pickle.loads(analysed.read_bytes())
            shelf.update({results / name: one for name, one in stored.items()})
        else:
            _analyse(folder, results)
        if analysed is not None and not analysed.is_file():
            wanted = {path.relative_to(results): one for path, one in shelf.items()}
            kept = {name: one for name, one in wanted.items() if name.parts[0] not in _DROPPED}
            analysed.parent.mkdir(parents=True, exist_ok=True)
            analysed.write_bytes(pickle.dumps(kept))
        recorded = time.process_time() - clock
        clock = time.process_time()
        verdict = _diagnose(folder, results, parametric)
        seconds = {"records": recorded, "diagnosis": time.process_time() - clock}
        return {**verdict, "seconds": seconds}


# The diagnosis reads the curves, stick.nc and integrity.nc.
_DROPPED = ("records", "plateau")


def _analyse(folder: Path, results: Path) -> None:
    stage("ringdown")  # the library's path
    from bladeroot.io.campaign import load_campaign
    from bladeroot.io.facts import record_facts

    campaign, config = load_campaign(folder), configuration()
    settings = {part: json.dumps(config[part]) for part in ("record", "decay", "stick")}
    batch = results / BATCH
    stage("ringdown")(
        [folder / row["file"] for row in campaign.records],
        json.dumps([record_facts(campaign, row) for row in campaign.records]),
        campaign.name,
        settings["record"],
        settings["decay"],
        "",
        results,
        batch,
    )
    stage("integrity")([batch], campaign.name, results / "integrity.nc")
    stage("stick")([batch], campaign.name, "{}", settings["stick"], results / "stick.nc")


# All records of a campaign are one batch.
BATCH = Path("batches/all.txt")


def judge(seen: xr.Dataset, model: xr.Dataset, independent: Sequence[dict] = ()) -> dict:
    """verdict.json on observations, with the shipped settings; `seconds` of CPU beside it.

    model: the analyst's `parametric.nc`.
    """
    stage("ringdown")  # the library's path
    from bladeroot.diagnosis import judged
    from bladeroot.mechanisms.catalogue import catalogue

    config, clock = configuration(), time.process_time()
    facts = {**config["diagnosis"], **config["search"], "independent": list(independent)}
    verdict = judged.judge(seen, model, facts, catalogue())[1]
    return {**verdict, "seconds": {"diagnosis": time.process_time() - clock}}


def _judged(seen: Path, parametric: Path, settings: str, results: Path) -> dict:
    from bladeroot import artifacts

    said = []
    keep, artifacts.save_json = artifacts.save_json, lambda verdict, _: said.append(verdict)
    try:
        stage("diagnosis")(seen, [str(parametric)], settings, results / "d.nc", results, None)
    finally:
        artifacts.save_json = keep
    return said[0]


def _diagnose(folder: Path, results: Path, parametric: Path) -> dict:
    from bladeroot.io.campaign import load_campaign
    from bladeroot.io.facts import diagnosis_facts, observation_facts

    campaign = load_campaign(folder)
    batch = results / BATCH
    if not batch.is_file():
        batch.parent.mkdir(parents=True)
        batch.write_text("".join(f"{row['record']}\n" for row in campaign.records))
    integrity, stick = results / "integrity.nc", results / "stick.nc"
    seen = results / "observations.nc"
    stage("observations")(
        stick, [batch], [integrity], json.dumps(observation_facts(campaign)), seen
    )
    facts = diagnosis_facts(campaign, configuration())
    return _judged(seen, parametric, json.dumps(facts), results)
