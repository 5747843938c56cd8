# Stick frequencies: of each record and pooled for each force, or as the campaign's table gives them.


def stick_sources(wildcards):
    """The campaign's table, or the batches of its records."""
    campaign = CAMPAIGNS[wildcards.campaign]
    if campaign.stick:
        return given([campaign.folder / "stick.csv"])
    return batch_lists(wildcards)


def load_of_table(wildcards):
    """What campaign.yaml says of the load of its table's rows; records have theirs in artifacts."""
    campaign = CAMPAIGNS[wildcards.campaign]
    keys = ("load", "force") if campaign.stick else ()
    said = campaign.description
    return canonical_json({key: said[key] for key in keys if key in said})


rule stick:
    input:
        sources=stick_sources,
        plateaus=of_records("plateau"),
    output:
        stick="results/{campaign}/stick.nc",
    log:
        "results/logs/stick/{campaign}.log",
    benchmark:
        "results/benchmarks/stick/{campaign}.tsv"
    priority: PRIORITY["stick"]
    threads: 1
    resources:
        **needs("stick"),
    params:
        load=load_of_table,
        settings=settings("stick"),
        code=code("stick"),
    message:
        "stick frequencies of {wildcards.campaign}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/stick.py --sources {input.sources:q} --campaign {wildcards.campaign}"
        " --load {params.load:q} --settings {params.settings:q} --output {output.stick} > {log} 2>&1"
