# Contact theory of chapter 6, and what it says beside the identified stiffness.


rule theory:
    input:
        stiffness=rules.stiffness.output.stiffness,
        parameters=given(FLANK),
        published=printed_tables("table_5_2"),
    output:
        theory="results/{campaign}/theory.nc",
    log:
        "results/logs/theory/{campaign}.log",
    benchmark:
        "results/benchmarks/theory/{campaign}.tsv"
    priority: PRIORITY["theory"]
    threads: 1
    resources:
        **needs("theory"),
    params:
        code=code("theory"),
    message:
        "contact theory beside the kn, kt of {wildcards.campaign} (6.3-6.16)"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/theory.py --stiffness {input.stiffness:q}"
        " --parameters {input.parameters:q} --published {input.published:q}"
        " --output {output.theory} > {log} 2>&1"
