# The search for kn, kt: one force of one structure, all of them together, and jointly over all forces.
import json


def search_results(campaign):
    return [
        f"results/{campaign.name}/stiffness/{structure}/{force}.nc"
        for structure in structures_of(campaign)
        for force in forces_of(campaign)
    ]


def thesis_search_results(campaign):
    return [
        f"results/{campaign.name}/thesis_search/{structure}.nc"
        for structure in structures_of(campaign)
    ]


# All forces and structures of a campaign are one job, with a rule of its own: an output can't be a list that grows.
for campaign in filter(structures_of, CAMPAIGNS.values()):

    rule:
        name:
            f"search.{campaign.name}"
        input:
            maps=[
                path
                for structure in structures_of(campaign)
                for path in artifacts_at_forces(structure, "map", forces_of(campaign))
            ],
            fe_forces=f"results/{campaign.name}/fe_forces.nc",
        output:
            stiffness=search_results(campaign),
        log:
            f"results/logs/search/{campaign.name}.log",
        benchmark:
            f"results/benchmarks/search/{campaign.name}.tsv"
        priority: PRIORITY["search"]
        threads: 1
        resources:
            **needs("search"),
        params:
            settings=settings("search"),
            code=code("search"),
        message:
            f"kn, kt of {campaign.name} with each structure at each force (5.8-5.24)"
        shell:
            "{PYTHON:q} {SCRIPTS:q}/search.py --maps {input.maps:q}"
            " --fe_forces {input.fe_forces:q} --settings {params.settings:q}"
            " --outputs {output.stiffness:q} > {log} 2>&1"


def searches(wildcards):
    return search_results(CAMPAIGNS[wildcards.campaign])


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
    priority: PRIORITY["joint"]
    threads: 1
    resources:
        **needs("joint"),
    params:
        settings=joint_facts,
        code=code("joint"),
    message:
        "kn, kt of {wildcards.campaign} with {wildcards.structure} from all forces at once"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/joint.py --parametric {input.parametric:q} --stick {input.stick:q}"
        " --settings {params.settings:q} --output {output.joint} > {log} 2>&1"


def joints(wildcards):
    return made(
        rules.joint.output.joint,
        campaign=wildcards.campaign,
        structure=structures_of(CAMPAIGNS[wildcards.campaign]),
    )


rule stiffness:
    input:
        searches=searches,
        fe_forces=rules.fe_forces.output.fe_forces,
        published=printed_tables("table_5_2"),
    output:
        stiffness="results/{campaign}/stiffness.nc",
    log:
        "results/logs/stiffness/{campaign}.log",
    benchmark:
        "results/benchmarks/stiffness/{campaign}.tsv"
    priority: PRIORITY["stiffness"]
    threads: 1
    resources:
        **needs("stiffness"),
    params:
        code=code("stiffness"),
    message:
        "kn, kt of {wildcards.campaign} over all forces"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/stiffness.py --searches {input.searches:q}"
        " --fe_forces {input.fe_forces:q} --published {input.published:q}"
        " --output {output.stiffness} > {log} 2>&1"


for campaign in filter(structures_of, CAMPAIGNS.values()):

    rule:
        name:
            f"thesis_search.{campaign.name}"
        input:
            parametrics=[
                f"results/structures/{structure}/parametric_equal_nodes.nc"
                for structure in structures_of(campaign)
            ],
            fe_forces=f"results/{campaign.name}/fe_forces.nc",
            tables=given(
                expand(
                    ROOT / "resources" / "thesis" / "{name}.csv",
                    name=["table_5_1", "table_5_2"],
                )
            ),
        output:
            searches=thesis_search_results(campaign),
        log:
            f"results/logs/thesis_search/{campaign.name}.log",
        benchmark:
            f"results/benchmarks/thesis_search/{campaign.name}.tsv"
        localrule: True
        threads: 1
        resources:
            **needs("thesis_search"),
        params:
            settings=settings("search"),
            code=code("thesis_search"),
        message:
            f"the thesis's own search of {campaign.name} with each structure (5.8-5.24)"
        shell:
            "{PYTHON:q} {SCRIPTS:q}/thesis_search.py --parametrics {input.parametrics:q}"
            " --fe_forces {input.fe_forces:q} --tables {input.tables:q}"
            " --settings {params.settings:q} --outputs {output.searches:q} > {log} 2>&1"


def thesis_searches(wildcards):
    """One for each structure, of campaigns that stand beside the thesis's tables."""
    campaign = CAMPAIGNS[wildcards.campaign]
    return thesis_search_results(campaign) if of_the_thesis(campaign) else []
