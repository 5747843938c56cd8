# What was found wrong in the records, by themselves and beside their repeats, and how a second
# estimator agrees: one table a campaign.


rule integrity:
    input:
        batches=batch_lists,
        records=of_records("records"),
        decays=of_records("decay"),
        plateaus=of_records("plateau"),
    output:
        integrity="results/{campaign}/integrity.nc",
    log:
        "results/logs/integrity/{campaign}.log",
    benchmark:
        "results/benchmarks/integrity/{campaign}.tsv"
    priority: PRIORITY["integrity"]
    threads: 1
    resources:
        **needs("integrity"),
    params:
        code=code("integrity"),
    message:
        "findings of all records of {wildcards.campaign}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/integrity.py --batches {input.batches:q}"
        " --campaign {wildcards.campaign} --output {output.integrity} > {log} 2>&1"
