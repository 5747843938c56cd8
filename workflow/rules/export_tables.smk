# Asked for by name: records, curves, stick frequencies and verdict for other programs.


rule export_tables:
    input:
        stick=rules.stick.output.stick,
        decays=of_records("decay"),
        curves=if_records(rules.curves.output.curves),
        verdict=with_structure(rules.verdict.output.verdict),
    output:
        folder=directory("results/{campaign}/export"),
    log:
        "results/logs/export_tables/{campaign}.log",
    benchmark:
        "results/benchmarks/export_tables/{campaign}.tsv"
    threads: 1
    resources:
        **needs("export_tables"),
    params:
        results=lambda w, input: os.path.dirname(input.stick),
        code=code("export_tables"),
    message:
        "curves, stick frequencies and verdict of {wildcards.campaign} as CSV, MATLAB and UFF"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/export_tables.py --results {params.results:q}"
        " --folder {output.folder} > {log} 2>&1"
