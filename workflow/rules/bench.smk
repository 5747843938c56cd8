# The virtual test bench: raw records of a campaign that names a bench file, labelled simulated.


def sheet_row(wildcards):
    """One record's row of the campaign's sheet as text: a changed row redoes only its record."""
    campaign = CAMPAIGNS[wildcards.campaign]
    return canonical_json(
        next(r for r in campaign.records if r["record"] == wildcards.record)
    )


rule bench:
    input:
        bench=lambda w: bench_of(CAMPAIGNS[w.campaign]),
        reduced=lambda w: expand(
            rules.reduced.output.reduced,
            structure=bench_structure(CAMPAIGNS[w.campaign]),
        ),
    output:
        raw="results/bench/{campaign}/{record}.nc",
        truth="results/bench/{campaign}/truth/{record}.nc",
    log:
        "results/logs/bench/{campaign}/{record}.log",
    benchmark:
        "results/benchmarks/bench/{campaign}/{record}.tsv"
    threads: 1
    params:
        row=sheet_row,
        code=code("bench"),
    message:
        "virtual bench: record {wildcards.record} of {wildcards.campaign} (simulated)"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/bench.py --bench {input.bench:q} --reduced {input.reduced:q}"
        " --row {params.row:q} --raw {output.raw} --truth {output.truth} > {log} 2>&1"
