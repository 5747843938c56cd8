# What was found wrong in the records, by themselves and beside their repeats, and how a second
# estimator agrees: one table a campaign.


rule integrity:
    input:
        records=lambda w: of_records(rules.record.output.record, w),
        decays=lambda w: of_records(rules.decay.output.decay, w),
        plateaus=lambda w: of_records(rules.decay.output.plateau, w),
    output:
        integrity="results/{campaign}/integrity.nc",
    log:
        "results/logs/integrity/{campaign}.log",
    benchmark:
        "results/benchmarks/integrity/{campaign}.tsv"
    threads: 1
    params:
        code=code("integrity"),
    message:
        "findings of all records of {wildcards.campaign}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/integrity.py --records {input.records:q} --decays {input.decays:q}"
        " --plateaus {input.plateaus:q} --campaign {wildcards.campaign} --output {output.integrity} > {log} 2>&1"
