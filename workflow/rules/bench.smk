# The virtual test bench: raw records of a campaign that names a bench file, labelled simulated.
# A batch of records is one job, with a rule of its own: a rule's outputs can't be a list that grows.

# To simulate a record takes a second: a changed row redoes few others.
BENCH_BATCH = 8


def rows_of(campaign, names):
    """The rows of these records as text: a changed row redoes only its batch."""
    return canonical_json([r for r in campaign.records if r["record"] in set(names)])


for campaign in CAMPAIGNS.values():
    if not campaign.simulated:
        continue
    for batch, names in batches_of(campaign, BENCH_BATCH).items():

        rule:
            name:
                f"bench.{campaign.name}.{batch}"
            input:
                bench=bench_of(campaign),
                reduced=f"results/structures/{bench_structure(campaign)}/reduced.nc",
            output:
                raw=[f"results/bench/{campaign.name}/{name}.nc" for name in names],
                truth=[
                    f"results/bench/{campaign.name}/truth/{name}.nc" for name in names
                ],
            log:
                f"results/logs/bench/{campaign.name}/{batch}.log",
            benchmark:
                f"results/benchmarks/bench/{campaign.name}/{batch}.tsv"
            threads: 1
            params:
                rows=rows_of(campaign, names),
                folder=f"results/bench/{campaign.name}",
                code=code("bench"),
            message:
                f"virtual bench: {len(names)} records of {campaign.name} (simulated)"
            shell:
                "{PYTHON:q} {SCRIPTS:q}/bench.py --bench {input.bench:q} --reduced {input.reduced:q}"
                " --rows {params.rows:q} --folder {params.folder:q} > {log} 2>&1"
