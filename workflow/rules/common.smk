# What every rule uses: the checked configuration and campaigns, and what a stage's parameters hold.
import os
import re
import sys

from functools import cache
from pathlib import Path

ROOT = Path(workflow.basedir)
# This checkout's library, before an installed one, which may be another checkout's; the scripts
# do the same (_cli.py).
sys.path.insert(0, str(ROOT / "workflow"))

from bladeroot.bytecode import follow_content

follow_content()  # before more of the library is read

from bladeroot.nonlinear.settings import check_nonlinear
from bladeroot.provenance import canonical_json, code_hash, environment_hash
from bladeroot.io.batches import batches
from bladeroot.io.campaign import load_campaign
from bladeroot.io.names import SPECIAL, SPECIAL_TEXT
from bladeroot.schema import check, read_yaml
from bladeroot.rom.file import named_structure

SCRIPTS = ROOT / "workflow" / "scripts"
FLANK = ROOT / "resources" / "structures" / "flank.csv"  # of the shipped dovetails
PYTHON = sys.executable

# Several jobs share the cores: a job that starts a thread per core slows the others down.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")


def refuse(faults):
    """End the run before any job with one line a fault."""
    for line in str(faults).splitlines():
        print(f"bad input: {line}", file=sys.stderr)
    sys.exit(1)


def add_structure(name, campaign, structures, modes=(), loads=()):
    """Find a structure's file, in the campaign's folder or in resources/structures/."""
    path = named_structure(name, campaign.folder, modes, loads)
    if structures.setdefault(name, path) != path:
        raise ValueError(
            f"two structures are named {name!r}: {structures[name]} and {path}"
        )


def bench_of(campaign):
    """Path of the virtual bench's file of a simulated campaign."""
    return (campaign.folder / campaign.description["bench"]).resolve()


def bench_structure(campaign):
    """Name of the structure that a simulated campaign's bench is made of."""
    return _structure_named(bench_of(campaign))


@cache
def _structure_named(bench):
    # every record's job asks
    return read_yaml(bench, "bench")["structure"]


def with_numbers(node):
    """The configuration with the numbers that a command line could only give as text."""
    if isinstance(node, dict):
        return {key: with_numbers(part) for key, part in node.items()}
    if isinstance(node, list):
        return [with_numbers(part) for part in node]
    try:
        return float(node) if isinstance(node, str) else node
    except ValueError:
        return node


def campaign_folder(name):
    """A folder of that path, else the shipped campaign of that name."""
    is_path = Path(name).is_dir() or os.sep in name.rstrip(os.sep)
    shipped = ROOT / "resources" / "campaigns"
    return Path(name).resolve() if is_path else shipped / name.rstrip(os.sep)


def checked_campaigns():
    """The campaigns by name and the structure files by name, with all their files checked."""
    asked = config["campaigns"]
    names = (
        [name.strip() for name in asked.split(",")] if isinstance(asked, str) else asked
    )
    for key in config.keys() - {"campaigns"}:
        config[key] = with_numbers(config[key])
    check({**config, "campaigns": names}, "config", "config/config.yaml or --config")
    check_nonlinear(config["nonlinear"])
    for path in (config["model"], config["diagnosis"]["mechanisms"]):
        if SPECIAL & set(path):
            raise ValueError(f"a path must have none of {SPECIAL_TEXT}: {path}")
    campaigns, structures, faults = {}, {}, []
    for name in names:
        folder = campaign_folder(name)
        try:
            campaign = load_campaign(folder)
            modes = campaign.description["modes"]
            loads = [row["load"] for row in campaign.records or campaign.stick]
            for structure in campaign.description["structure"]:
                add_structure(structure, campaign, structures, modes, loads)
            if campaign.simulated:
                add_structure(bench_structure(campaign), campaign, structures)
        except ValueError as error:
            faults.append(str(error))
            continue
        if campaign.name in campaigns:
            faults.append(
                f"two campaigns are named {campaign.name!r}: {folder} and another"
            )
        campaigns[campaign.name] = campaign
    if faults:
        raise ValueError("\n".join(faults))
    return campaigns, structures


try:
    CAMPAIGNS, STRUCTURES = checked_campaigns()
except ValueError as error:
    refuse(error)


def tell_warnings():
    """What looks wrong in the campaigns' sheets and the settings and is no fault."""
    for campaign in CAMPAIGNS.values():
        for line in campaign.warnings:
            print(f"warning: {line}", file=sys.stderr)
    known = {mode for one in CAMPAIGNS.values() for mode in one.description["modes"]}
    for key in ("fe_bias_percent", "fe_offset_percent"):
        for mode in sorted(config["search"][key].keys() - known):
            # those of a dovetail stand in the shipped settings
            if not re.fullmatch("[1-9][0-9]*[BLT]", mode):
                text = f"warning: search.{key}: no campaign has a mode {mode}"
                print(text, file=sys.stderr)


# Once, before the work: a wrong digit is best put right before it.
tell_warnings()


def structures_of(campaign):
    """Names of the dovetails to compare with; none where the measurement stands alone."""
    dovetails = campaign.description["simulation"] == "structure"
    lacks = not dovetails or campaign.structure_lacks
    return [] if lacks else campaign.description["structure"]


def judged_against(campaign):
    """What the diagnosis compares with: structures, a table, or linear modes."""
    if campaign.description["structure"]:
        return campaign.description["structure"]
    return ["linear" if campaign.description["simulation"] == "none" else "table"]


def made(files, **wildcards):
    """Files of a rule's output, of each combination of wildcards.

    A storage plugin has put its own place before the patterns and does it again with what an input
    function returns, so it is taken off here.
    """
    files = [files] if isinstance(files, str) else list(files)
    before = workflow.storage_settings.default_storage_prefix or ""
    for number, file in enumerate(files):
        stored = getattr(file, "flags", {}).get("storage_object")
        if stored is not None:
            files[number] = stored.query.removeprefix(before).lstrip("/")
    return expand(list(map(str, files)), **wildcards)


def with_structure(files):
    """An input function: what is made of a campaign that has a structure, else nothing."""
    return lambda w: made(files, **w) if structures_of(CAMPAIGNS[w.campaign]) else []


def of_the_thesis(campaign):
    """Whether a campaign stands beside the thesis's tables, as `published` in its file says."""
    return campaign.description.get("published") == "thesis"


def printed_tables(*names):
    """An input function: these tables of the thesis for a campaign of it, for others none."""
    files = [ROOT / "resources" / "thesis" / f"{name}.csv" for name in names]
    return lambda w: given(files) if of_the_thesis(CAMPAIGNS[w.campaign]) else []


def forces_of(campaign):
    """FE axial forces of a campaign in whole newtons, as they stand in file names."""
    asked = campaign.description.get("fe_forces_kN", config["fe_forces_kN"])
    return sorted({round(1000 * force) for force in asked})


def refuse_forces_outside_the_model():
    """Every FE force must lie in the box of the parametric model."""
    low, high = config["parametric"]["force_kN"]
    for campaign in filter(structures_of, CAMPAIGNS.values()):
        asked = [force / 1000 for force in forces_of(campaign)]
        if not low <= min(asked) <= max(asked) <= high:
            refuse(
                f"{campaign.name}: fe_forces_kN must lie between {low:g} and {high:g}"
                f" (parametric.force_kN), got {', '.join(f'{f:g}' for f in asked)}"
            )


refuse_forces_outside_the_model()


def batches_of(campaign, most):
    """The names of a campaign's records by batch; with more records no other batch changes."""
    return batches([row["record"] for row in campaign.records], most)


def kept(files):
    """Outputs of a batch that its job finds as they are: those that are still current it leaves."""
    return [update(file) for file in files]


def of_records(stage):
    """Input function: the artifacts of all records of a campaign after a stage."""
    return lambda w: [
        f"results/{w.campaign}/{stage}/{row['record']}.nc"
        for row in CAMPAIGNS[w.campaign].records
    ]


def given(files):
    """Files that no job makes, beside the working directory: a folder that is moved is the same."""
    if isinstance(files, (str, Path)):
        return local(os.path.relpath(files))
    return [given(file) for file in files]


def structure_file(wildcards):
    return given(STRUCTURES[wildcards.structure])


def batch_lists(wildcards):
    """Which records the batches of a campaign hold: short enough for a command line."""
    made = batches_of(CAMPAIGNS[wildcards.campaign], RINGDOWN_BATCH)
    return [f"results/{wildcards.campaign}/batches/{batch}.txt" for batch in made]


def folder_of_output(wildcards, output):
    """Where a job writes: with a storage plugin not below results/, but in the plugin's copy of it."""
    return os.path.dirname(output[0])


ENVIRONMENT = environment_hash(config.get("keep_environment", ""))


@cache  # every batch asks
def code(script, *files):
    """Hash of what computes a stage: its script with all that it imports, further files of Python,
    and the versions of the numerical libraries.
    """
    return f"{code_hash(SCRIPTS / f'{script}.py', *files)} {ENVIRONMENT}"


def settings(section):
    """The settings of one stage as text; what a stage does not read cannot rerun it."""
    return canonical_json(config[section])


def pieces(text, most=30_000):
    """A text as arguments of a command line, each short enough for Linux (131,072 bytes)."""
    return [text[k : k + most] for k in range(0, len(text), most)]


wildcard_constraints:
    campaign="[A-Za-z0-9][A-Za-z0-9_-]*",
    record="[A-Za-z0-9][A-Za-z0-9_-]*",
    structure="[A-Za-z0-9][A-Za-z0-9_-]*",
    force="[0-9]+",
