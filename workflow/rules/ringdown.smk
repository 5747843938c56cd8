# From raw records to frequency and damping over amplitude: each record's free decay, its curves
# (FREEVIB, with peak finding and fitting as a second opinion) and its stick plateau.
# A batch of records is one job, with a rule of its own: a rule's outputs can't be a list that grows.
from bladeroot.io.facts import record_facts

# Records of a batch: with its start, and loading the compiled code, as much as some fifteen records cost, a
# batch of this size is four fifths arithmetic. When a record is added or changed its job keeps the others.
RINGDOWN_BATCH = 64


def raw_file(campaign, row):
    if campaign.simulated:
        return f"results/bench/{campaign.name}/{row['record']}.nc"
    return given(campaign.folder / row["file"])


def as_it_stands(text):
    """A parameter whose braces are no wildcards: channels may be called `data{3,2}`."""
    return lambda wildcards: text


for campaign in CAMPAIGNS.values():
    rows = {row["record"]: row for row in campaign.records}
    for batch, names in batches_of(campaign, RINGDOWN_BATCH).items():

        rule:
            name:
                f"ringdown.{campaign.name}.{batch}"
            input:
                raw=[raw_file(campaign, rows[name]) for name in names],
            output:
                records=kept(
                    f"results/{campaign.name}/records/{name}.nc" for name in names
                ),
                decays=kept(
                    f"results/{campaign.name}/decay/{name}.nc" for name in names
                ),
                plateaus=kept(
                    f"results/{campaign.name}/plateau/{name}.nc" for name in names
                ),
                batch=f"results/{campaign.name}/batches/{batch}.txt",
            log:
                f"results/logs/ringdown/{campaign.name}/{batch}.log",
            benchmark:
                f"results/benchmarks/ringdown/{campaign.name}/{batch}.tsv"
            priority: PRIORITY["ringdown"]
            threads: 1
            resources:
                **needs("ringdown"),
            params:
                facts=as_it_stands(
                    canonical_json(
                        [record_facts(campaign, rows[name]) for name in names]
                    )
                ),
                campaign=campaign.name,
                record=settings("record"),
                decay=settings("decay"),
                folder=lambda w, output: os.path.dirname(os.path.dirname(output.batch)),
                code=code("ringdown"),
            message:
                f"free decays and their curves: {len(names)} records of {campaign.name}"
            shell:
                "{PYTHON:q} {SCRIPTS:q}/ringdown.py --raw {input.raw:q} --facts {params.facts:q}"
                " --campaign {params.campaign} --record_settings {params.record:q}"
                " --decay_settings {params.decay:q} --code {params.code:q} --folder {params.folder:q}"
                " --batch {output.batch:q} > {log} 2>&1"
