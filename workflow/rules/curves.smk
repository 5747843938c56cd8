# Frequency and damping over amplitude for each mode and force: all records' curves as one.


rule curves:
    input:
        decays=lambda w: of_records(rules.decay.output.decay, w),
        plateaus=lambda w: of_records(rules.decay.output.plateau, w),
    output:
        curves="results/{campaign}/curves.nc",
    log:
        "results/logs/curves/{campaign}.log",
    benchmark:
        "results/benchmarks/curves/{campaign}.tsv"
    threads: 1
    params:
        code=code("curves"),
    message:
        "mean curves over amplitude of {wildcards.campaign}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/curves.py --decays {input.decays:q} --plateaus {input.plateaus:q}"
        " --campaign {wildcards.campaign} --output {output.curves} > {log} 2>&1"
