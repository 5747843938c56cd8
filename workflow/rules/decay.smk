# Frequency and damping against amplitude (FREEVIB) of each free decay, a second opinion (peak
# finding and fitting), and the stick plateau.


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
        settings=settings("decay"),
        code=code("decay"),
    message:
        "frequency and damping against amplitude, record {wildcards.record} of {wildcards.campaign}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/decay.py --record {input.record:q}"
        " --settings {params.settings:q} --decay {output.decay}"
        " --plateau {output.plateau} > {log} 2>&1"
