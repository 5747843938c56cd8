# The thesis number by number beside what is computed here, for the campaign of its own tables.


# By itself: all that analyses records is compiled for it, while the structures are made.
rule slider:
    input:
        printed=given(ROOT / "resources" / "thesis" / "ledger.yaml"),
    output:
        slider="results/{campaign}/slider.nc",
    log:
        "results/logs/slider/{campaign}.log",
    benchmark:
        "results/benchmarks/slider/{campaign}.tsv"
    priority: PRIORITY["slider"]
    threads: 1
    resources:
        **needs("slider"),
    params:
        code=code("slider"),
    message:
        "the thesis's model of one degree of freedom, and FREEVIB on it (3.3)"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/slider.py --campaign {wildcards.campaign} --output {output.slider}"
        " > {log} 2>&1"


rule ledger:
    input:
        stages=[
            rules.stick.output.stick,
            rules.fe_forces.output.fe_forces,
            rules.stiffness.output.stiffness,
            rules.theory.output.theory,
            rules.slider.output.slider,
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
        parameters=given(FLANK),
    output:
        ledger="results/{campaign}/ledger.nc",
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
        " --parameters {input.parameters:q} --output {output.ledger} > {log} 2>&1"
