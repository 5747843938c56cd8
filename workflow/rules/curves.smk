# Frequency and damping over amplitude for each mode and force: all records' curves as one.


rule curves:
    input:
        batches=batch_lists,
        decays=of_records("decay"),
        plateaus=of_records("plateau"),
    output:
        curves="results/{campaign}/curves.nc",
    log:
        "results/logs/curves/{campaign}.log",
    benchmark:
        "results/benchmarks/curves/{campaign}.tsv"
    threads: 1
    resources:
        **needs("curves"),
    params:
        code=code("curves"),
    message:
        "mean curves over amplitude of {wildcards.campaign}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/curves.py --batches {input.batches:q}"
        " --campaign {wildcards.campaign} --output {output.curves} > {log} 2>&1"
