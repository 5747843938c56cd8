# The search for kn, kt: one force of one structure, all of them together, and jointly over all forces.
import json


rule search:
    input:
        map=rules.frequency_map.output.map,
        fe_forces=rules.fe_forces.output.fe_forces,
    output:
        stiffness="results/{campaign}/stiffness/{structure}/{force}.nc",
    log:
        "results/logs/search/{campaign}/{structure}/{force}.log",
    benchmark:
        "results/benchmarks/search/{campaign}/{structure}/{force}.tsv"
    threads: 1
    params:
        settings=settings("search"),
        code=code("search"),
    message:
        "kn, kt of {wildcards.campaign} with {wildcards.structure} at {wildcards.force} N (5.8-5.24)"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/search.py --map {input.map:q} --fe_forces {input.fe_forces:q}"
        " --settings {params.settings:q} --output {output.stiffness} > {log} 2>&1"


def searches(wildcards):
    campaign = CAMPAIGNS[wildcards.campaign]
    return expand(
        rules.search.output.stiffness,
        campaign=campaign.name,
        structure=structures_of(campaign),
        force=forces_of(campaign),
    )


def joint_facts(wildcards):
    """What the joint inference reads: forces, the gauge, the model's bias, where contact is full."""
    campaign = CAMPAIGNS[wildcards.campaign]
    least = campaign.description.get("full_contact_from_kN", 0)
    return canonical_json(
        {
            "gauge": json.loads(force_facts(wildcards)),
            "least_force": 1000.0 * least,
            **config["search"],
        }
    )


rule joint:
    input:
        parametric=rules.parametric.output.parametric,
        stick=rules.stick.output.stick,
    output:
        joint="results/{campaign}/joint/{structure}.nc",
    log:
        "results/logs/joint/{campaign}/{structure}.log",
    benchmark:
        "results/benchmarks/joint/{campaign}/{structure}.tsv"
    threads: 1
    params:
        settings=joint_facts,
        code=code("joint"),
    message:
        "kn, kt of {wildcards.campaign} with {wildcards.structure} from all forces at once"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/joint.py --parametric {input.parametric:q} --stick {input.stick:q}"
        " --settings {params.settings:q} --output {output.joint} > {log} 2>&1"


def joints(wildcards):
    return expand(
        rules.joint.output.joint,
        campaign=wildcards.campaign,
        structure=structures_of(CAMPAIGNS[wildcards.campaign]),
    )


rule stiffness:
    input:
        searches=searches,
        fe_forces=rules.fe_forces.output.fe_forces,
        published=ROOT / "resources" / "thesis" / "table_5_2.csv",
    output:
        stiffness="results/{campaign}/stiffness.nc",
    log:
        "results/logs/stiffness/{campaign}.log",
    benchmark:
        "results/benchmarks/stiffness/{campaign}.tsv"
    threads: 1
    params:
        code=code("stiffness"),
    message:
        "kn, kt of {wildcards.campaign} over all forces"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/stiffness.py --searches {input.searches:q}"
        " --fe_forces {input.fe_forces:q} --published {input.published:q}"
        " --output {output.stiffness} > {log} 2>&1"


rule thesis_search:
    input:
        parametric=rules.parametric_equal_nodes.output.parametric,
        fe_forces=rules.fe_forces.output.fe_forces,
        tables=expand(
            ROOT / "resources" / "thesis" / "{name}.csv",
            name=["table_5_1", "table_5_2"],
        ),
    output:
        search="results/{campaign}/thesis_search/{structure}.nc",
    log:
        "results/logs/thesis_search/{campaign}/{structure}.log",
    benchmark:
        "results/benchmarks/thesis_search/{campaign}/{structure}.tsv"
    threads: 1
    params:
        settings=settings("search"),
        code=code("thesis_search"),
    message:
        "the thesis's own search of {wildcards.campaign} with {wildcards.structure} (5.8-5.24)"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/thesis_search.py --parametric {input.parametric:q}"
        " --fe_forces {input.fe_forces:q} --tables {input.tables:q}"
        " --settings {params.settings:q} --output {output.search} > {log} 2>&1"


def thesis_searches(wildcards):
    """One for each structure, of campaigns that stand beside the thesis's tables."""
    campaign = CAMPAIGNS[wildcards.campaign]
    if campaign.description.get("published") != "thesis":
        return []
    return expand(
        rules.thesis_search.output.search,
        campaign=campaign.name,
        structure=structures_of(campaign),
    )
