# The search for kn, kt: one force of one structure, then all of them together.


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
