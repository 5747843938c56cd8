# kn, kt and friction from stick frequencies and amplitude curves together.
import json


def amplitude_facts(wildcards):
    """As for the joint inference, with the laser's places (m) and how far curves are trusted."""
    campaign = CAMPAIGNS[wildcards.campaign]
    lasers = {mode: campaign.laser_x(mode) for mode in campaign.description["modes"]}
    return canonical_json(
        {**json.loads(joint_facts(wildcards)), **config["amplitude"], "lasers": lasers}
    )


rule amplitude:
    input:
        reduced=rules.reduced.output.reduced,
        parametric=rules.parametric.output.parametric,
        stick=rules.stick.output.stick,
        observations="results/{campaign}/observations.nc",
    output:
        amplitude="results/{campaign}/amplitude/{structure}.nc",
    log:
        "results/logs/amplitude/{campaign}/{structure}.log",
    benchmark:
        "results/benchmarks/amplitude/{campaign}/{structure}.tsv"
    priority: PRIORITY["amplitude"]
    threads: 1
    resources:
        **needs("amplitude"),
    params:
        settings=amplitude_facts,
        code=code("amplitude"),
    message:
        "kn, kt of {wildcards.campaign} with {wildcards.structure} from frequencies and amplitude curves"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/amplitude.py --reduced {input.reduced:q} --parametric {input.parametric:q}"
        " --stick {input.stick:q} --observations {input.observations:q} --settings {params.settings:q}"
        " --output {output.amplitude} > {log} 2>&1"


def amplitudes(wildcards):
    """One for each structure, of campaigns that have records."""
    campaign = CAMPAIGNS[wildcards.campaign]
    if not campaign.records:
        return []
    return made(
        rules.amplitude.output.amplitude,
        campaign=campaign.name,
        structure=structures_of(campaign),
    )


rule shortfall:
    input:
        reduced=rules.reduced.output.reduced,
    output:
        shortfall="results/structures/{structure}/shortfall.nc",
    log:
        "results/logs/shortfall/{structure}.log",
    benchmark:
        "results/benchmarks/shortfall/{structure}.tsv"
    threads: 1
    resources:
        **needs("shortfall"),
    params:
        code=code("shortfall"),
    message:
        "where slip begins in {wildcards.structure}, by pressure over the flanks"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/shortfall.py --reduced {input.reduced:q}"
        " --output {output.shortfall} > {log} 2>&1"
