# Frequency and damping against amplitude, simulated with friction at the flanks.


def nonlinear_facts(wildcards):
    """What the simulation reads: where the laser stands, and section `nonlinear`."""
    campaign = CAMPAIGNS[wildcards.campaign]
    return canonical_json(
        {
            "laser_x_mm": {
                mode: 1000 * campaign.laser_x(mode)
                for mode in campaign.description["modes"]
            },
            **config["nonlinear"],
        }
    )


rule nonlinear:
    input:
        reduced=rules.reduced.output.reduced,
        joint=rules.joint.output.joint,
        parameters=given(FLANK),
    output:
        nonlinear="results/{campaign}/nonlinear/{structure}.nc",
    log:
        "results/logs/nonlinear/{campaign}/{structure}.log",
    benchmark:
        "results/benchmarks/nonlinear/{campaign}/{structure}.tsv"
    threads: 1
    resources:
        **needs("nonlinear"),
    params:
        settings=nonlinear_facts,
        code=code("nonlinear"),
    message:
        "f_n(A), eta(A) of {wildcards.campaign} with {wildcards.structure} and friction"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/nonlinear.py --reduced {input.reduced:q} --joint {input.joint:q}"
        " --parameters {input.parameters:q} --settings {params.settings:q}"
        " --output {output.nonlinear} > {log} 2>&1"


def nonlinears(wildcards):
    return made(
        rules.nonlinear.output.nonlinear,
        campaign=wildcards.campaign,
        structure=structures_of(CAMPAIGNS[wildcards.campaign]),
    )
