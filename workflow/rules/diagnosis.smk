# What the simulation gets wrong: all records as one table, then their causes, for each structure.
from bladeroot.io.facts import diagnosis_facts, observation_facts
from bladeroot.mechanisms.own_files import own_files


def mechanism_files():
    """The user's mechanisms; a missing folder or a file that is not Python ends the run."""
    folder = config["diagnosis"]["mechanisms"]
    try:
        return own_files(folder) if folder else []
    except ValueError as error:
        refuse(error)


MECHANISMS = mechanism_files()


rule observations:
    input:
        stick=rules.stick.output.stick,
        batches=batch_lists,
        decays=of_records("decay"),
        integrity=lambda w: (
            made(rules.integrity.output.integrity, **w)
            if CAMPAIGNS[w.campaign].records
            else []
        ),
    output:
        observations="results/{campaign}/observations.nc",
    log:
        "results/logs/observations/{campaign}.log",
    benchmark:
        "results/benchmarks/observations/{campaign}.tsv"
    priority: PRIORITY["observations"]
    threads: 1
    resources:
        **needs("observations"),
    params:
        settings=lambda w: pieces(
            canonical_json(observation_facts(CAMPAIGNS[w.campaign]))
        ),
        code=code("observations"),
    message:
        "all records of {wildcards.campaign} as the diagnosis takes them"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/observations.py --stick {input.stick:q} --batches {input.batches:q}"
        " --integrity {input.integrity:q} --settings {params.settings:q}"
        " --output {output.observations} > {log} 2>&1"


def simulation_file(wildcards):
    """What the diagnosis judges: a structure's model, the campaign's table, or nothing."""
    if wildcards.structure in STRUCTURES:
        return made(rules.parametric.output.parametric, structure=wildcards.structure)
    campaign = CAMPAIGNS[wildcards.campaign]
    if wildcards.structure == "table":
        return given(campaign.folder / campaign.description["simulation"])
    return []


rule diagnosis:
    input:
        observations=rules.observations.output.observations,
        parametric=simulation_file,
        mechanisms=given(MECHANISMS),
    output:
        diagnosis="results/{campaign}/diagnosis/{structure}.nc",
        verdict="results/{campaign}/diagnosis/{structure}.json",
        model="results/{campaign}/diagnosis/{structure}.model.yaml",
    log:
        "results/logs/diagnosis/{campaign}/{structure}.log",
    benchmark:
        "results/benchmarks/diagnosis/{campaign}/{structure}.tsv"
    priority: PRIORITY["diagnosis"]
    threads: 1
    resources:
        **needs("diagnosis"),
    params:
        settings=lambda w: canonical_json(
            diagnosis_facts(CAMPAIGNS[w.campaign], config)
        ),
        code=code("diagnosis", *MECHANISMS),
    message:
        "diagnosis of {wildcards.campaign} against {wildcards.structure}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/diagnosis.py --observations {input.observations:q}"
        " --parametric {input.parametric:q} --settings {params.settings:q}"
        " --diagnosis {output.diagnosis} --verdict {output.verdict} --model {output.model}"
        " > {log} 2>&1"


def main_verdict(wildcards):
    """The verdict with the campaign's first structure, which is its main one, or without any."""
    return made(
        rules.diagnosis.output.verdict,
        campaign=wildcards.campaign,
        structure=judged_against(CAMPAIGNS[wildcards.campaign])[0],
    )


rule verdict:
    input:
        verdict=main_verdict,
    output:
        verdict="results/{campaign}/diagnosis/verdict.json",
    log:
        "results/logs/verdict/{campaign}.log",
    benchmark:
        "results/benchmarks/verdict/{campaign}.tsv"
    threads: 1
    resources:
        **needs("verdict"),
    message:
        "verdict on {wildcards.campaign}"
    shell:
        "cp {input.verdict:q} {output.verdict} > {log} 2>&1"


# A structure could be named "verdict".
ruleorder: verdict > diagnosis


def diagnoses(wildcards):
    """The diagnosis with every structure of a campaign, for the report."""
    return made(
        rules.diagnosis.output.diagnosis,
        campaign=wildcards.campaign,
        structure=judged_against(CAMPAIGNS[wildcards.campaign]),
    )


def verdicts(wildcards):
    """The verdict with every structure of a campaign, for the report."""
    return made(
        rules.diagnosis.output.verdict,
        campaign=wildcards.campaign,
        structure=judged_against(CAMPAIGNS[wildcards.campaign]),
    )
