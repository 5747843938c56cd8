"""Records of one batch -> records/<record>.nc, decay/<record>.nc, plateau/<record>.nc of each."""

import json
import traceback
from pathlib import Path

from _cli import run
from bladeroot import artifacts, statement
from bladeroot.files import save_text

STAGES = ("records", "decay", "plateau")


def main(raw, facts, campaign, record_settings, decay_settings, code, folder, batch):
    settings = record_settings, decay_settings, decay_settings
    cutting, estimating = json.loads(record_settings), json.loads(decay_settings)
    parts = [
        statement.Part(
            known, [path], [f"{folder}/{stage}/{known['record']}.nc" for stage in STAGES]
        )
        for path, known in zip(raw, json.loads(facts), strict=True)
    ]
    stated = statement.statements(Path(folder).parent, f"ringdown/{campaign}")
    shared = [campaign, record_settings, decay_settings, code]
    current = statement.still_current(stated, shared, [], parts)
    _try_together([part for part in parts if part.facts["record"] not in current])
    for part in parts:
        known, (path,) = part.facts, part.inputs
        if known["record"] in current:
            statement.renew(part)
            continue
        from bladeroot.decay.from_file import from_file, not_analysed
        from bladeroot.reproduction.thesis_filters import estimation

        try:
            made = from_file(path, known, cutting, estimation(estimating))
        except MemoryError:
            raise  # the batch is asked for again with more
        except Exception as error:
            # One record's fault must not take its batch along; the end of the run names it.
            traceback.print_exc()
            reason = f"its analysis broke off: {type(error).__name__}: {error}"
            made = not_analysed(known, reason, estimation(estimating))
        for place, one, said in zip(part.outputs, made, settings, strict=True):
            artifacts.save(one.assign_attrs(campaign=campaign), place, settings=said)
    names = [part.facts["record"] for part in parts]
    save_text("\n".join(names) + "\n", batch)


def _try_together(parts):
    """Damaged files catch a child process, one for all that are read."""
    if not parts:
        return
    from bladeroot.io.hdf5 import try_together
    from bladeroot.io.read import as_stated

    said = ("channel", "quantity")
    try_together(as_stated, ((one.inputs[0], *(one.facts[n] for n in said)) for one in parts))


if __name__ == "__main__":
    run(
        main,
        raw="many: raw files",
        facts="list of what is known of each record besides its samples (JSON)",
        campaign="the campaign's name",
        record_settings="section `record` of the configuration (JSON)",
        decay_settings="section `decay` of the configuration (JSON)",
        code="hash of the code; a record that this code has made of the same is kept",
        folder=f"where the folders {', '.join(STAGES)} go",
        batch="list of the batch's records to write, a name a line",
    )
