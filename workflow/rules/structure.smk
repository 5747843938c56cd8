# The finite-element structure, once for all forces and campaigns: mesh, prestress, reduction, checks.


rule reduced:
    input:
        structure=structure_file,
    output:
        mesh="results/structures/{structure}/mesh.nc",
        prestress="results/structures/{structure}/prestress.nc",
        reduced="results/structures/{structure}/reduced.nc",
    log:
        "results/logs/reduced/{structure}.log",
    benchmark:
        "results/benchmarks/reduced/{structure}.tsv"
    priority: PRIORITY["reduced"]
    threads: 1
    resources:
        **needs("reduced"),
    params:
        code=code("reduced"),
    message:
        "mesh, static stress (4.2) and Craig-Bampton reduction (4.3-4.12) of {wildcards.structure}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/reduced.py --structure {input.structure:q} --mesh {output.mesh}"
        " --prestress {output.prestress} --output {output.reduced} > {log} 2>&1"


rule shapes:
    input:
        structure=structure_file,
        mesh=rules.reduced.output.mesh,
    output:
        shapes="results/structures/{structure}/shapes.nc",
        modes="results/structures/{structure}/modes.svg",
    log:
        "results/logs/shapes/{structure}.log",
    benchmark:
        "results/benchmarks/shapes/{structure}.tsv"
    threads: 1
    resources:
        **needs("shapes"),
    params:
        code=code("shapes"),
    message:
        "mode shapes of the free beam of {wildcards.structure}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/shapes.py --structure {input.structure:q} --mesh {input.mesh:q}"
        " --output {output.shapes} --drawing {output.modes}"
        " > {log} 2>&1"


rule checks:
    input:
        structure=structure_file,
        mesh=rules.reduced.output.mesh,
        prestress=rules.reduced.output.prestress,
        reduced=rules.reduced.output.reduced,
        tables=given(
            expand(
                ROOT / "resources" / "thesis" / "table_{table}.csv",
                table=["2_2", "4_1", "4_2", "4_4"],
            )
        ),
    output:
        checks="results/structures/{structure}/checks.nc",
    log:
        "results/logs/checks/{structure}.log",
    benchmark:
        "results/benchmarks/checks/{structure}.tsv"
    priority: PRIORITY["checks"]
    threads: 1
    resources:
        **needs("checks"),
    params:
        code=code("checks"),
    message:
        "{wildcards.structure} against the thesis's Tables 2.2, 4.1, 4.2 and 4.4"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/checks.py --structure {input.structure:q} --mesh {input.mesh:q}"
        " --prestress {input.prestress:q} --reduced {input.reduced:q} --tables {input.tables:q}"
        " --output {output.checks} > {log} 2>&1"
