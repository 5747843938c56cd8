# The joint's parametric model, once for all forces, and its accuracy; and at each force: beam and slots
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
    priority: PRIORITY["parametric"]
    threads: 1
    resources:
        **needs("parametric"),
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
    priority: 0
    params:
        settings=settings("parametric"),
        springs="equal",
        code=code("parametric"),
    message:
        "frequencies of {wildcards.structure} with equal nodal springs, as in the thesis (5.4-5.7)"


def forces_with(structure):
    """All axial forces in whole newtons at which any campaign uses a structure."""
    users = [c for c in CAMPAIGNS.values() if structure in structures_of(c)]
    return sorted({force for campaign in users for force in forces_of(campaign)})


def forces_used(wildcards):
    return canonical_json([float(force) for force in forces_with(wildcards.structure)])


rule accuracy:
    input:
        structure=structure_file,
        mesh=rules.reduced.output.mesh,
        prestress=rules.reduced.output.prestress,
        parametric=rules.parametric.output.parametric,
    output:
        accuracy="results/structures/{structure}/accuracy.nc",
    log:
        "results/logs/accuracy/{structure}.log",
    benchmark:
        "results/benchmarks/accuracy/{structure}.tsv"
    priority: PRIORITY["accuracy"]
    threads: 1
    resources:
        **needs("accuracy"),
    params:
        forces=forces_used,
        code=code("accuracy"),
    message:
        "{wildcards.structure}: parametric model against the full one at every force"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/accuracy.py --structure {input.structure:q} --mesh {input.mesh:q}"
        " --prestress {input.prestress:q} --parametric {input.parametric:q}"
        " --forces {params.forces:q} --output {output.accuracy} > {log} 2>&1"


def artifacts_at_forces(structure, stage, forces):
    """One file for each axial force: a structure's `assembly` or `map`."""
    return [f"results/structures/{structure}/{stage}/{force}.nc" for force in forces]


# All forces of a structure are one job, with a rule of its own: an output can't be a list that grows.
for structure in STRUCTURES:
    forces = forces_with(structure)
    if not forces:  # of a bench alone
        continue

    rule:
        name:
            f"frequency_maps.{structure}"
        input:
            reduced=f"results/structures/{structure}/reduced.nc",
            parametric=f"results/structures/{structure}/parametric.nc",
        output:
            assemblies=artifacts_at_forces(structure, "assembly", forces),
            maps=artifacts_at_forces(structure, "map", forces),
        log:
            f"results/logs/frequency_maps/{structure}.log",
        benchmark:
            f"results/benchmarks/frequency_maps/{structure}.tsv"
        threads: 1
        resources:
            **needs("frequency_maps"),
        params:
            code=code("frequency_maps"),
        message:
            f"{structure}: assembly (5.1) and frequencies over (kn, kt) (5.4-5.7), {len(forces)} forces"
        shell:
            "{PYTHON:q} {SCRIPTS:q}/frequency_maps.py --reduced {input.reduced:q}"
            " --parametric {input.parametric:q} --assemblies {output.assemblies:q}"
            " --maps {output.maps:q} > {log} 2>&1"
