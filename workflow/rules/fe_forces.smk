# Stick frequencies interpolated to the forces of the simulation (5.13, 5.14).


def force_facts(wildcards):
    """The simulation's forces and the gauge's accuracy, in newtons."""
    campaign = CAMPAIGNS[wildcards.campaign]
    load = campaign.load
    return canonical_json(
        {
            "forces": [float(force) for force in forces_of(campaign)],
            "full_scale_std": load.of_full_scale,
            "relative_std": load.of_reading,
            "primary": "reading" if load.accuracy_of == "reading" else "full-scale",
        }
    )


rule fe_forces:
    input:
        stick=rules.stick.output.stick,
    output:
        fe_forces="results/{campaign}/fe_forces.nc",
    log:
        "results/logs/fe_forces/{campaign}.log",
    benchmark:
        "results/benchmarks/fe_forces/{campaign}.tsv"
    priority: PRIORITY["fe_forces"]
    threads: 1
    resources:
        **needs("fe_forces"),
    params:
        settings=force_facts,
        code=code("fe_forces"),
    message:
        "stick frequencies of {wildcards.campaign} at the simulation's forces"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/fe_forces.py --stick {input.stick:q} --settings {params.settings:q}"
        " --output {output.fe_forces} > {log} 2>&1"
