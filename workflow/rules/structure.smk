# The finite-element structure, once for all forces and campaigns: mesh, prestress, reduction, checks.


rule mesh:
    input:
        structure=structure_file,
    output:
        mesh="results/structures/{structure}/mesh.nc",
    log:
        "results/logs/mesh/{structure}.log",
    benchmark:
        "results/benchmarks/mesh/{structure}.tsv"
    priority: PRIORITY["mesh"]
    threads: 1
    resources:
        **needs("mesh"),
    params:
        code=code("mesh"),
    message:
        "mesh of {wildcards.structure}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/mesh.py --structure {input.structure:q} --output {output.mesh}"
        " > {log} 2>&1"


rule prestress:
    input:
        structure=structure_file,
        mesh=rules.mesh.output.mesh,
    output:
        prestress="results/structures/{structure}/prestress.nc",
    log:
        "results/logs/prestress/{structure}.log",
    benchmark:
        "results/benchmarks/prestress/{structure}.tsv"
    priority: PRIORITY["prestress"]
    threads: 1
    resources:
        **needs("prestress"),
    params:
        code=code("prestress"),
    message:
        "static stress of {wildcards.structure} under axial force (4.2)"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/prestress.py --structure {input.structure:q} --mesh {input.mesh:q}"
        " --output {output.prestress}"
        " > {log} 2>&1"


rule shapes:
    input:
        structure=structure_file,
        mesh=rules.mesh.output.mesh,
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


rule reduced:
    input:
        structure=structure_file,
        mesh=rules.mesh.output.mesh,
        prestress=rules.prestress.output.prestress,
    output:
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
        "Craig-Bampton reduction of {wildcards.structure} (4.3-4.12)"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/reduced.py --structure {input.structure:q} --mesh {input.mesh:q}"
        " --prestress {input.prestress:q} --output {output.reduced} > {log} 2>&1"


rule checks:
    input:
        structure=structure_file,
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
        "{PYTHON:q} {SCRIPTS:q}/checks.py --structure {input.structure:q} --tables {input.tables:q}"
        " --output {output.checks} > {log} 2>&1"
