# Structures that are no dovetail: matrices of any bodies and interfaces, and the built-in lap joint.
# One rule takes the place of reduced; the parametric model is as of a dovetail.
from bladeroot.io.simulation import OF_ASSEMBLIES
from bladeroot.rom.file import ASSEMBLY, kind_of

ASSEMBLIES = {
    name: path for name, path in STRUCTURES.items() if kind_of(path) in OF_ASSEMBLIES
}


def files_of_assembly(wildcards):
    """What the structure's file names: tables and matrices; nothing of a built-in one."""
    from bladeroot.rom.external.assembly import files_of, read_assembly

    path = ASSEMBLIES[wildcards.structure]
    return given(files_of(read_assembly(path))) if kind_of(path) == ASSEMBLY else []


ruleorder: assembly_reduced > matrices_reduced > reduced
ruleorder: export_assembly > export


rule assembly_reduced:
    input:
        structure=structure_file,
        files=files_of_assembly,
    output:
        reduced="results/structures/{structure}/reduced.nc",
    log:
        "results/logs/assembly_reduced/{structure}.log",
    benchmark:
        "results/benchmarks/assembly_reduced/{structure}.tsv"
    wildcard_constraints:
        structure=names_of(ASSEMBLIES),
    threads: 1
    resources:
        **needs("assembly_reduced"),
    params:
        code=code("assembly_reduced"),
    message:
        "bodies and interfaces of {wildcards.structure}, reduced (4.3-4.12)"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/assembly_reduced.py --structure {input.structure:q}"
        " --output {output.reduced} > {log} 2>&1"


# Asked for by name: the built-in lap joint's full matrices, as files of kind `assembly`.
rule export_assembly:
    input:
        structure=structure_file,
    output:
        folder=directory("results/structures/{structure}/matrices-mtx"),
    log:
        "results/logs/export_assembly/{structure}.log",
    benchmark:
        "results/benchmarks/export_assembly/{structure}.tsv"
    wildcard_constraints:
        structure=names_of(ASSEMBLIES),
    threads: 1
    resources:
        **needs("export_assembly"),
    params:
        code=code("export_assembly"),
    message:
        "full matrices of {wildcards.structure} as mtx files"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/export_assembly.py --structure {input.structure:q}"
        " --output {output.folder} > {log} 2>&1"
