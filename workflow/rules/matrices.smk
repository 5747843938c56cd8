# Bring your own model: structures of kind `matrices` take these rules instead of reduced;
# from reduced.nc on all structures are alike. And the own matrices, for other programs.
from bladeroot.rom.file import is_matrices

MATRICES = sorted(name for name, path in STRUCTURES.items() if is_matrices(path))


def names_of(structures):
    """Pattern of a wildcard that is one of these names; with none it fits nothing."""
    return "|".join(structures) or "(?!)"


def described_by(files):
    """Input function: what the structure's file names, its tables or its matrices."""

    def of_structure(wildcards):
        from bladeroot.rom.external import description

        described = description.read_description(STRUCTURES[wildcards.structure])
        return given(getattr(description, files)(described))

    return of_structure


ruleorder: matrices_mesh > reduced
ruleorder: matrices_reduced > reduced
ruleorder: matrices_checks > checks
ruleorder: matrices_accuracy > accuracy


rule matrices_mesh:
    input:
        structure=structure_file,
        tables=described_by("tables_of"),
    output:
        mesh="results/structures/{structure}/mesh.nc",
    log:
        "results/logs/matrices_mesh/{structure}.log",
    benchmark:
        "results/benchmarks/matrices_mesh/{structure}.tsv"
    wildcard_constraints:
        structure=names_of(MATRICES),
    threads: 1
    resources:
        **needs("matrices_mesh"),
    params:
        code=code("matrices_mesh"),
    message:
        "nodes and contact pairs of {wildcards.structure}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/matrices_mesh.py --structure {input.structure:q}"
        " --output {output.mesh} > {log} 2>&1"


rule matrices_reduced:
    input:
        structure=structure_file,
        mesh=rules.matrices_mesh.output.mesh,
        matrices=described_by("matrix_files_of"),
    output:
        reduced="results/structures/{structure}/reduced.nc",
    log:
        "results/logs/matrices_reduced/{structure}.log",
    benchmark:
        "results/benchmarks/matrices_reduced/{structure}.tsv"
    wildcard_constraints:
        structure=names_of(MATRICES),
    threads: 1
    resources:
        **needs("matrices_reduced"),
    params:
        code=code("matrices_reduced"),
    message:
        "Craig-Bampton reduction of the matrices of {wildcards.structure} (4.3-4.12)"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/matrices_reduced.py --structure {input.structure:q}"
        " --mesh {input.mesh:q} --output {output.reduced} > {log} 2>&1"


rule matrices_checks:
    input:
        structure=structure_file,
        mesh=rules.matrices_mesh.output.mesh,
        matrices=described_by("matrix_files_of"),
    output:
        checks="results/structures/{structure}/checks.nc",
    log:
        "results/logs/matrices_checks/{structure}.log",
    benchmark:
        "results/benchmarks/matrices_checks/{structure}.tsv"
    wildcard_constraints:
        structure=names_of(MATRICES),
    threads: 1
    resources:
        **needs("matrices_checks"),
    params:
        code=code("matrices_checks"),
    message:
        "mass, rigid motions and load of {wildcards.structure}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/matrices_checks.py --structure {input.structure:q}"
        " --mesh {input.mesh:q} --output {output.checks} > {log} 2>&1"


rule matrices_accuracy:
    input:
        structure=structure_file,
        mesh=rules.matrices_mesh.output.mesh,
        matrices=described_by("matrix_files_of"),
        parametric=rules.parametric.output.parametric,
    output:
        accuracy="results/structures/{structure}/accuracy.nc",
    log:
        "results/logs/matrices_accuracy/{structure}.log",
    benchmark:
        "results/benchmarks/matrices_accuracy/{structure}.tsv"
    wildcard_constraints:
        structure=names_of(MATRICES),
    threads: 1
    resources:
        **needs("matrices_accuracy"),
    params:
        forces=forces_used,
        code=code("matrices_accuracy"),
    message:
        "{wildcards.structure}: parametric model against the full matrices at every force"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/matrices_accuracy.py --structure {input.structure:q}"
        " --mesh {input.mesh:q} --parametric {input.parametric:q} --forces {params.forces:q}"
        " --output {output.accuracy} > {log} 2>&1"


# Asked for by name: the full matrices of a dovetail, as files of kind `matrices`.
rule export:
    input:
        structure=structure_file,
        mesh=rules.reduced.output.mesh,
        prestress=rules.reduced.output.prestress,
    output:
        folder=directory("results/structures/{structure}/matrices-{form}"),
    log:
        "results/logs/export/{structure}-{form}.log",
    benchmark:
        "results/benchmarks/export/{structure}-{form}.tsv"
    wildcard_constraints:
        form="mtx|hb",
    threads: 1
    resources:
        **needs("export"),
    params:
        code=code("export"),
    message:
        "full matrices of {wildcards.structure} as {wildcards.form} files"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/export.py --structure {input.structure:q} --mesh {input.mesh:q}"
        " --prestress {input.prestress:q} --form {wildcards.form} --output {output.folder}"
        " > {log} 2>&1"


def middle_of_the_box():
    """kn and kt for shapes to look at: the geometric middle of the parametric model's box."""
    low, high = config["parametric"]["stiffness_GN_per_m"]
    return f"{1e9 * (low * high) ** 0.5:g}"


# Asked for by name: mesh and mode shapes at one force, for ParaView.
rule paraview:
    input:
        structure=structure_file,
        mesh=rules.reduced.output.mesh,
        prestress=lambda w: (
            []
            if w.structure in MATRICES
            else made(rules.reduced.output.prestress, **w)
        ),
        matrices=lambda w: (
            described_by("matrix_files_of")(w) if w.structure in MATRICES else []
        ),
    output:
        modes="results/structures/{structure}/modes/{force}.vtu",
    log:
        "results/logs/paraview/{structure}/{force}.log",
    benchmark:
        "results/benchmarks/paraview/{structure}/{force}.tsv"
    threads: 1
    resources:
        **needs("paraview"),
    params:
        prestress=lambda w, input: (
            f"--prestress {input.prestress}" if input.prestress else ""
        ),
        stiffness=middle_of_the_box(),
        code=code("paraview"),
    message:
        "mode shapes of {wildcards.structure} at {wildcards.force} N for ParaView"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/paraview.py --structure {input.structure:q} --mesh {input.mesh:q}"
        " {params.prestress} --force {wildcards.force}"
        " --stiffness {params.stiffness} {params.stiffness} --output {output.modes} > {log} 2>&1"
