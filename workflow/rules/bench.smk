# The virtual test bench: raw records of a campaign that names a bench file, labelled simulated.
# A batch of records is one job, with a rule of its own: a rule's outputs can't be a list that grows.

# Clampings a batch: the records of one share most of their work.
BENCH_CLAMPINGS = 4


def rows_by_batch(campaign):
    """The sheet's rows of each batch of clampings; more clampings change no other batch."""
    made = batches({row["hold"] for row in campaign.records}, BENCH_CLAMPINGS)
    return {
        # by name: another order of the sheet is the same work
        batch: sorted(
            (row for row in campaign.records if row["hold"] in holds),
            key=lambda row: row["record"],
        )
        for batch, holds in made.items()
    }


for campaign in CAMPAIGNS.values():
    if not campaign.simulated:
        continue
    for batch, rows in rows_by_batch(campaign).items():

        rule:
            name:
                f"bench.{campaign.name}.{batch}"
            input:
                bench=given(bench_of(campaign)),
                reduced=f"results/structures/{bench_structure(campaign)}/reduced.nc",
            output:
                raw=kept(
                    f"results/bench/{campaign.name}/{row['record']}.nc" for row in rows
                ),
                truth=kept(
                    f"results/bench/{campaign.name}/truth/{row['record']}.nc"
                    for row in rows
                ),
            log:
                f"results/logs/bench/{campaign.name}/{batch}.log",
            benchmark:
                f"results/benchmarks/bench/{campaign.name}/{batch}.tsv"
            priority: PRIORITY["bench"]
            threads: 1
            resources:
                **needs("bench"),
            params:
                rows=canonical_json(rows),
                folder=folder_of_output,
                code=code("bench"),
            message:
                f"virtual bench: {len(rows)} records of {campaign.name} (simulated)"
            shell:
                "{PYTHON:q} {SCRIPTS:q}/bench.py --bench {input.bench:q} --reduced {input.reduced:q}"
                " --rows {params.rows:q} --code {params.code:q} --folder {params.folder:q} > {log} 2>&1"
