# The score of simulated records against the bench's truth, and the report with its figures.


rule score:
    input:
        stick=rules.stick.output.stick,
        truths=lambda w: [
            f"results/bench/{w.campaign}/truth/{row['record']}.nc"
            for row in CAMPAIGNS[w.campaign].records
        ],
    output:
        score="results/{campaign}/score.nc",
    log:
        "results/logs/score/{campaign}.log",
    benchmark:
        "results/benchmarks/score/{campaign}.tsv"
    threads: 1
    resources:
        **needs("score"),
    params:
        truths=lambda w, input: os.path.dirname(input.truths[0]),
        code=code("score"),
    message:
        "stick frequencies of {wildcards.campaign} against the bench's truth"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/score.py --stick {input.stick:q} --truths {params.truths:q}"
        " --output {output.score} > {log} 2>&1"


def report_facts(wildcards):
    """What the report says of the campaign besides its artifacts."""
    campaign = CAMPAIGNS[wildcards.campaign]
    return canonical_json(
        {
            "campaign": campaign.name,
            "description": campaign.description,
            # JSON has them by the alphabet
            "modes": list(campaign.description["modes"]),
            "structures": structures_of(campaign),
            "judged": judged_against(campaign),
            "extended": extended_by(campaign),
            "forces": forces_of(campaign),
            "simulated": campaign.simulated,
            "excluded": campaign.excluded,
            "entry": "records" if campaign.records else "stick frequencies",
            "settings": {
                name: canonical_json(part)
                for name, part in config.items()
                if name in ("record", "decay", "stick", "diagnosis")
                or (structures_of(campaign) and name != "campaigns")
            },
            "command": f"bladeroot run {os.path.relpath(campaign.folder)}",
        }
    )


def calibrations_made(wildcards):
    """Calibrations of the campaign's structures that exist: they are made when asked for."""
    possible = made(
        rules.calibrate.output.calibration,
        structure=structures_of(CAMPAIGNS[wildcards.campaign]),
    )
    return [path for path in possible if Path(path).is_file()]


def sources_of(wildcards):
    """The files that a person wrote; the script adds the measured ones, too many to be named here."""
    campaign = CAMPAIGNS[wildcards.campaign]
    sheet = "records.csv" if campaign.records else "stick.csv"
    files = [campaign.folder / name for name in ("campaign.yaml", sheet)]
    files += [bench_of(campaign)] if campaign.simulated else []
    return files + [STRUCTURES[name] for name in structures_of(campaign)]


def of_structures(files):
    """An input function: what is made of each structure of a campaign."""
    return lambda w: made(files, structure=structures_of(CAMPAIGNS[w.campaign]))


def if_records(files):
    """An input function: what is made of a campaign that has records, else nothing."""
    return lambda w: made(files, **w) if CAMPAIGNS[w.campaign].records else []


rule report:
    input:
        stick=rules.stick.output.stick,
        fe_forces=with_structure(rules.fe_forces.output.fe_forces),
        stiffness=with_structure(rules.stiffness.output.stiffness),
        searches=searches,
        joints=joints,
        diagnoses=diagnoses,
        verdicts=verdicts,
        extended=extended_joints,
        main_verdict=rules.verdict.output.verdict,
        amplitudes=amplitudes,
        thesis_searches=thesis_searches,
        theory=with_structure(rules.theory.output.theory),
        shortfalls=of_structures(rules.shortfall.output.shortfall),
        checks=of_structures(rules.checks.output.checks),
        accuracies=of_structures(rules.accuracy.output.accuracy),
        meshes=of_structures(rules.reduced.output.mesh),
        calibrations=calibrations_made,
        modes=lambda w: made(
            rules.shapes.output.modes,
            # mode shapes are drawn on elements, which given matrices do not have
            structure=[
                name
                for name in structures_of(CAMPAIGNS[w.campaign])[:1]
                if name not in MATRICES
            ],
        ),
        batches=batch_lists,
        records=of_records("records"),
        decays=of_records("decay"),
        integrity=if_records(rules.integrity.output.integrity),
        curves=if_records(rules.curves.output.curves),
        score=lambda w: (
            made(rules.score.output.score, **w)
            if CAMPAIGNS[w.campaign].simulated
            else []
        ),
        ledger=lambda w: (
            made([rules.ledger.output.ledger, rules.slider.output.slider], **w)
            if of_the_thesis(CAMPAIGNS[w.campaign])
            else []
        ),
        sources=lambda w: given(sources_of(w)),
        tables=printed_tables("table_5_1", "table_5_2"),
        errata=lambda w: (
            given([ROOT / "resources" / "thesis" / "errata.yaml"])
            if of_the_thesis(CAMPAIGNS[w.campaign])
            else []
        ),
        page=given(
            expand(
                ROOT / "workflow" / "bladeroot" / "report" / "page.{ending}",
                ending=["html.j2", "css", "js"],
            )
        ),
    output:
        report="results/{campaign}/report.html",
        chapters=report(
            directory("results/{campaign}/report"),
            htmlindex="index.html",
            caption="../report/report.rst",
            category="{campaign}",
        ),
    log:
        "results/logs/report/{campaign}.log",
    benchmark:
        "results/benchmarks/report/{campaign}.tsv"
    threads: 2
    resources:
        **needs("report"),
    params:
        results=folder_of_output,
        structures=lambda w, input: os.path.dirname(
            os.path.dirname((input.meshes or ["structures/none/mesh.nc"])[0])
        ),
        folder=lambda w: CAMPAIGNS[w.campaign].folder,
        facts=report_facts,
        code=code("report"),
    message:
        "report of {wildcards.campaign}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/report.py --results {params.results:q}"
        " --structures {params.structures:q} --batches {input.batches:q} --modes {input.modes:q}"
        " --calibrations {input.calibrations:q} --sources {input.sources:q}"
        " --tables {input.tables:q} --errata {input.errata:q} --folder {params.folder:q} --facts {params.facts:q}"
        " --threads {threads} > {log} 2>&1"
