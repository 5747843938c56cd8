# The stages once more with the simulation that a model file extends by named causes.

import json


def refuse_bad_model():
    """A model needs a joint inference that it changes; a file must be there, right, and of one."""
    asked = config["model"]
    if not asked:
        return
    inferred = {
        name for campaign in CAMPAIGNS.values() for name in structures_of(campaign)
    }
    if not inferred:
        refuse(
            "model: it redoes the joint inference, which only a campaign that is judged against a dovetail has;"
            " of an assembly, a table or linear modes there is nothing to redo"
        )
    if asked == "diagnosis":
        return
    try:
        structure = read_yaml(asked, "model")["structure"]
    except ValueError as error:
        refuse(error)
    if structure not in inferred:
        refuse(
            f"model: structure must be one of {', '.join(sorted(inferred))}, got {structure!r} ({asked})"
        )


refuse_bad_model()


def extended_by(campaign):
    """Structures of a campaign that a model file extends."""
    asked = config["model"]
    if asked == "diagnosis":
        return structures_of(campaign)
    wanted = read_yaml(asked, "model")["structure"] if asked else None
    return [name for name in structures_of(campaign) if name == wanted]


def model_of(wildcards):
    """The model file: the campaign's own diagnosis, or the one that is given."""
    if config["model"] == "diagnosis":
        return made(rules.diagnosis.output.model, **wildcards)
    return given(config["model"])


rule extended_structure:
    input:
        parametric=rules.parametric.output.parametric,
        model=model_of,
    output:
        parametric="results/{campaign}/extended/{structure}/parametric.nc",
    log:
        "results/logs/extended_structure/{campaign}/{structure}.log",
    benchmark:
        "results/benchmarks/extended_structure/{campaign}/{structure}.tsv"
    threads: 1
    resources:
        **needs("extended_structure"),
    params:
        settings=settings("diagnosis"),
        code=code("extended_structure", *MECHANISMS),
    message:
        "{wildcards.structure} with the matrices that its model file changes, for {wildcards.campaign}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/extended_structure.py --parametric {input.parametric:q}"
        " --model {input.model:q} --settings {params.settings:q}"
        " --output {output.parametric} > {log} 2>&1"


def extended_facts(wildcards):
    """What the joint inference reads, and where mechanisms are."""
    return canonical_json({**json.loads(joint_facts(wildcards)), **config["diagnosis"]})


rule extended_joint:
    input:
        parametric=rules.parametric.output.parametric,
        observations=rules.observations.output.observations,
        model=model_of,
    output:
        joint="results/{campaign}/extended/{structure}/joint.nc",
    log:
        "results/logs/extended_joint/{campaign}/{structure}.log",
    benchmark:
        "results/benchmarks/extended_joint/{campaign}/{structure}.tsv"
    threads: 1
    resources:
        **needs("extended_joint"),
    params:
        settings=extended_facts,
        code=code("extended_joint", *MECHANISMS),
    message:
        "kn, kt of {wildcards.campaign} with {wildcards.structure}, extended by its causes"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/extended_joint.py --parametric {input.parametric:q}"
        " --observations {input.observations:q} --model {input.model:q}"
        " --settings {params.settings:q} --output {output.joint} > {log} 2>&1"


def extended_nonlinear_facts(wildcards):
    """What the nonlinear stage reads, and where mechanisms are."""
    return canonical_json(
        {**json.loads(nonlinear_facts(wildcards)), **config["diagnosis"]}
    )


# When asked for by name: f_n(A), eta(A) with kn, kt of the extended law and the amplitude causes,
# or with friction where the model file has none.
rule extended_nonlinear:
    input:
        reduced=rules.reduced.output.reduced,
        joint=rules.extended_joint.output.joint,
        model=model_of,
        parameters=given(FLANK),
    output:
        nonlinear="results/{campaign}/extended/{structure}/nonlinear.nc",
    log:
        "results/logs/extended_nonlinear/{campaign}/{structure}.log",
    benchmark:
        "results/benchmarks/extended_nonlinear/{campaign}/{structure}.tsv"
    threads: 1
    resources:
        **needs("extended_nonlinear"),
    params:
        settings=extended_nonlinear_facts,
        code=code("nonlinear", *MECHANISMS),
    message:
        "f_n(A), eta(A) of {wildcards.campaign} with {wildcards.structure}, extended by its causes"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/nonlinear.py --reduced {input.reduced:q} --joint {input.joint:q}"
        " --parameters {input.parameters:q} --settings {params.settings:q}"
        " --model {input.model:q} --output {output.nonlinear} > {log} 2>&1"


def extended_joints(wildcards):
    campaign = CAMPAIGNS[wildcards.campaign]
    return made(
        rules.extended_joint.output.joint,
        campaign=campaign.name,
        structure=extended_by(campaign),
    )
