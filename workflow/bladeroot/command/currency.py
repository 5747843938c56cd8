"""Whether a result is what its inputs, settings and code would make now, and why not."""

import json
import re
import subprocess
import sys
from pathlib import Path

from bladeroot import statement
from bladeroot.command.run import CHECKOUT

_JOB = re.compile(r"^Job \d+: (.*)\nReason: (.*)", re.MULTILINE)
# Snakemake's reasons that begin with a job itself; what files hold is told from statements.
_WORDS = {
    "Missing output files": "is not there",
    "Set of input files has changed": "other inputs than before",
    "Params have changed": "other settings or code than before",
    "Code has changed": "another command than before",
    "Incomplete output files": "was cut off",
    "Forced execution": "was cut off",
}


def why_not_current(target: str) -> list[str]:
    """A line for each stage that is to be done again before `target` is current; none if it is.

    target: a file that the workflow made, as a path from the working directory. The workflow
    itself decides, in a dry run with the `--config` of the run that made it. Raises ValueError if
    nothing states how the file was made, or the workflow cannot be planned.
    """
    results = Path("results")
    stated = statement.statements(results)
    made = [one for one in stated if target in one["outputs"]]
    if not made:
        raise ValueError(f"nothing states how {target} was made ({results / statement.FOLDER})")
    text = _plan(target, made[-1].get("config", {}))
    if "Nothing to be done" in text:
        return []
    content = statement.outdated(stated, statement.Contents(), results)
    lines = [f"{path}: {content[path]}" for path in _behind(target, stated) if content.get(path)]
    for stage, reason in _JOB.findall(text):
        lines += [f"{stage}: {ours}" for said, ours in _WORDS.items() if said in reason]
    lines += filter(None, [statement.other_environment(made[-1])])
    return lines or ["what it stands on is not current"]


def _behind(target: str, stated: list[dict]) -> list[str]:
    """A target and all that it stands on, as the statements have it."""
    found = [target]
    for path in found:
        for one in stated:
            if path in one["outputs"]:
                found += [source for source in one["inputs"] if source not in found]
    return found


def _plan(target: str, config: dict) -> str:
    asked = [
        sys.executable, "-m", "snakemake", "--dry-run", target,
        "--snakefile", str(CHECKOUT / "Snakefile"),
        "--workflow-profile", str(CHECKOUT / "profiles" / "default"),
    ]  # fmt: skip
    if config:
        asked += ["--config", *(f"{key}={json.dumps(value)}" for key, value in config.items())]
    done = subprocess.run(asked, capture_output=True, text=True, check=False)
    if done.returncode:
        lines = done.stderr.strip().splitlines() or ["no reason given"]
        raise ValueError(f"the workflow cannot be planned: {lines[-1]}")
    return done.stdout + done.stderr
