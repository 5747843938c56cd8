# The joint's parametric model, once for all forces, and its accuracy; and at one force: beam and slots
# joined (5.1) and the frequencies of the joint as a map of kn, kt.


rule parametric:
    input:
        reduced=rules.reduced.output.reduced,
    output:
        parametric="results/structures/{structure}/parametric.nc",
    log:
        "results/logs/parametric/{structure}.log",
    benchmark:
        "results/benchmarks/parametric/{structure}.tsv"
    threads: 1
    params:
        settings=settings("parametric"),
        springs="area",
        code=code("parametric"),
    message:
        "frequencies of {wildcards.structure} over (kn, kt, force), with an error bound (5.4-5.7)"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/parametric.py --reduced {input.reduced:q}"
        " --springs {params.springs} --settings {params.settings:q}"
        " --output {output.parametric} > {log} 2>&1"


# The thesis's equal nodal springs, for its own search alone.
use rule parametric as parametric_equal_nodes with:
    output:
        parametric="results/structures/{structure}/parametric_equal_nodes.nc",
    log:
        "results/logs/parametric_equal_nodes/{structure}.log",
    benchmark:
        "results/benchmarks/parametric_equal_nodes/{structure}.tsv"
    params:
        settings=settings("parametric"),
        springs="equal",
        code=code("parametric"),
    message:
        "frequencies of {wildcards.structure} with equal nodal springs, as in the thesis (5.4-5.7)"


def forces_with(wildcards):
    """All axial forces at which any campaign uses a structure."""
    users = [c for c in CAMPAIGNS.values() if wildcards.structure in structures_of(c)]
    return canonical_json(
        sorted({float(force) for campaign in users for force in forces_of(campaign)})
    )


rule accuracy:
    input:
        structure=structure_file,
        mesh=rules.mesh.output.mesh,
        prestress=rules.prestress.output.prestress,
        parametric=rules.parametric.output.parametric,
    output:
        accuracy="results/structures/{structure}/accuracy.nc",
    log:
        "results/logs/accuracy/{structure}.log",
    benchmark:
        "results/benchmarks/accuracy/{structure}.tsv"
    threads: 1
    params:
        forces=forces_with,
        code=code("accuracy"),
    message:
        "{wildcards.structure}: parametric model against the full one at every force"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/accuracy.py --structure {input.structure:q} --mesh {input.mesh:q}"
        " --prestress {input.prestress:q} --parametric {input.parametric:q}"
        " --forces {params.forces:q} --output {output.accuracy} > {log} 2>&1"


rule assembly:
    input:
        reduced=rules.reduced.output.reduced,
    output:
        assembly="results/structures/{structure}/assembly/{force}.nc",
    log:
        "results/logs/assembly/{structure}/{force}.log",
    benchmark:
        "results/benchmarks/assembly/{structure}/{force}.tsv"
    threads: 1
    params:
        code=code("assembly"),
    message:
        "assembly of {wildcards.structure} at {wildcards.force} N (5.1)"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/assembly.py --reduced {input.reduced:q} --force {wildcards.force}"
        " --output {output.assembly} > {log} 2>&1"


rule frequency_map:
    input:
        parametric=rules.parametric.output.parametric,
        assembly=rules.assembly.output.assembly,
    output:
        map="results/structures/{structure}/map/{force}.nc",
    log:
        "results/logs/frequency_map/{structure}/{force}.log",
    benchmark:
        "results/benchmarks/frequency_map/{structure}/{force}.tsv"
    threads: 1
    params:
        code=code("frequency_map"),
    message:
        "frequencies of {wildcards.structure} over (kn, kt) at {wildcards.force} N (5.4-5.7)"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/frequency_map.py --parametric {input.parametric:q}"
        " --assembly {input.assembly:q} --output {output.map} > {log} 2>&1"
