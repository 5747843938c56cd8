"""Records of one batch -> records/<record>.nc, decay/<record>.nc, plateau/<record>.nc of each."""

import json
import traceback

from _cli import run
from bladeroot import artifacts
from bladeroot.decay.ringdown import not_analysed, ringdown
from bladeroot.io.hdf5 import try_together
from bladeroot.io.read import as_stated

STAGES = ("records", "decay", "plateau")


def main(raw, facts, campaign, record_settings, decay_settings, folder, batch):
    settings = record_settings, decay_settings, decay_settings
    cutting, estimation = json.loads(record_settings), json.loads(decay_settings)
    every, names = json.loads(facts), []
    asked = ((at, one["channel"], one["quantity"]) for at, one in zip(raw, every, strict=True))
    try_together(as_stated, asked)
    for path, known in zip(raw, every, strict=True):
        try:
            made = ringdown(path, known, cutting, estimation)
        except MemoryError:
            raise  # the batch is asked for again with more
        except Exception as error:
            # One record's fault must not take its batch along; the end of the run names it.
            traceback.print_exc()
            reason = f"its analysis broke off: {type(error).__name__}: {error}"
            made = not_analysed(known, reason, estimation)
        for stage, part, said in zip(STAGES, made, settings, strict=True):
            place = f"{folder}/{stage}/{known['record']}.nc"
            artifacts.save(part.assign_attrs(campaign=campaign), place, settings=said)
        names.append(known["record"])
    artifacts.save_text("\n".join(names) + "\n", batch)


if __name__ == "__main__":
    run(
        main,
        raw="many: raw files",
        facts="list of what is known of each record besides its samples (JSON)",
        campaign="the campaign's name",
        record_settings="section `record` of the configuration (JSON)",
        decay_settings="section `decay` of the configuration (JSON)",
        folder=f"where the folders {', '.join(STAGES)} go",
        batch="list of the batch's records to write, a name a line",
    )
