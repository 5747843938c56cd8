# The thesis number by number beside what is computed here, for the campaign of its own tables.


def of_the_thesis(campaign):
    return campaign.description.get("published") == "thesis"


rule ledger:
    input:
        stages=[
            rules.stick.output.stick,
            rules.fe_forces.output.fe_forces,
            rules.stiffness.output.stiffness,
            rules.theory.output.theory,
        ],
        checks=lambda w: made(
            rules.checks.output.checks, structure=structures_of(CAMPAIGNS[w.campaign])
        ),
        reduced=lambda w: made(
            rules.reduced.output.reduced,
            structure=structures_of(CAMPAIGNS[w.campaign]),
        ),
        maps=lambda w: [
            path
            for structure in structures_of(CAMPAIGNS[w.campaign])
            for path in artifacts_at_forces(
                structure, "map", forces_of(CAMPAIGNS[w.campaign])
            )
        ],
        printed=given(
            sorted((ROOT / "resources" / "thesis").glob("*.csv"))
            + sorted((ROOT / "resources" / "thesis").glob("*.yaml"))
        ),
    output:
        ledger="results/{campaign}/ledger.nc",
        slider="results/{campaign}/slider.nc",
    log:
        "results/logs/ledger/{campaign}.log",
    benchmark:
        "results/benchmarks/ledger/{campaign}.tsv"
    threads: 1
    resources:
        **needs("ledger"),
    params:
        thesis=ROOT / "resources" / "thesis",
        code=code("ledger"),
    message:
        "every number of the thesis beside those of {wildcards.campaign}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/ledger.py --stages {input.stages:q} --checks {input.checks:q}"
        " --reduced {input.reduced:q} --maps {input.maps:q} --thesis {params.thesis:q}"
        " --output {output.ledger} --slider {output.slider} > {log} 2>&1"
