# Frequency and damping against amplitude (FREEVIB) of each free decay, and its stick plateau.


rule decay:
    input:
        record=rules.record.output.record,
    output:
        decay="results/{campaign}/decay/{record}.nc",
        plateau="results/{campaign}/plateau/{record}.nc",
    log:
        "results/logs/decay/{campaign}/{record}.log",
    benchmark:
        "results/benchmarks/decay/{campaign}/{record}.tsv"
    threads: 1
    params:
        code=code("decay"),
    message:
        "frequency and damping against amplitude, record {wildcards.record} of {wildcards.campaign}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/decay.py --record {input.record:q}"
        " --decay {output.decay} --plateau {output.plateau} > {log} 2>&1"
