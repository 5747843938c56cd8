# Figures, the score of simulated records against the bench's truth, and the report.


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


rule figures_records:
    input:
        batches=batch_lists,
        records=of_records("records"),
        decays=of_records("decay"),
        curves=rules.curves.output.curves,
    output:
        cuts=report(
            "results/{campaign}/figures/cuts.svg",
            caption="../report/cuts.rst",
            category="{campaign}",
            subcategory="measurement",
        ),
        spectra=report(
            "results/{campaign}/figures/spectra.svg",
            caption="../report/spectra.rst",
            category="{campaign}",
            subcategory="measurement",
        ),
        backbones=report(
            "results/{campaign}/figures/backbones.svg",
            caption="../report/backbones.rst",
            category="{campaign}",
            subcategory="measurement",
        ),
        waterfall=report(
            "results/{campaign}/figures/waterfall.svg",
            caption="../report/waterfall.rst",
            category="{campaign}",
            subcategory="measurement",
        ),
        amplitude_force=report(
            "results/{campaign}/figures/amplitude_force.svg",
            caption="../report/amplitude_force.rst",
            category="{campaign}",
            subcategory="measurement",
        ),
    log:
        "results/logs/figures_records/{campaign}.log",
    benchmark:
        "results/benchmarks/figures_records/{campaign}.tsv"
    threads: 1
    resources:
        **needs("figures_records"),
    params:
        folder=folder_of_output,
        code=code("figures_records"),
    message:
        "figures of the records of {wildcards.campaign}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/figures_records.py --batches {input.batches:q}"
        " --curves {input.curves:q} --folder {params.folder:q} > {log} 2>&1"


rule figures_stick:
    input:
        stick=rules.stick.output.stick,
        fe_forces=with_structure(rules.fe_forces.output.fe_forces),
    output:
        stick=report(
            "results/{campaign}/figures/stick.svg",
            caption="../report/stick.rst",
            category="{campaign}",
            subcategory="measurement",
        ),
    log:
        "results/logs/figures_stick/{campaign}.log",
    benchmark:
        "results/benchmarks/figures_stick/{campaign}.tsv"
    threads: 1
    resources:
        **needs("figures_stick"),
    params:
        simulated=lambda w: int(CAMPAIGNS[w.campaign].simulated),
        code=code("figures_stick"),
    message:
        "figure of the stick frequencies of {wildcards.campaign}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/figures_stick.py --stick {input.stick:q} --fe_forces {input.fe_forces:q}"
        " --simulated {params.simulated} --output {output.stick} > {log} 2>&1"


rule figures:
    input:
        searches=searches,
        stiffness=rules.stiffness.output.stiffness,
        joints=joints,
        theory=rules.theory.output.theory,
        published=given(ROOT / "resources" / "thesis" / "table_5_2.csv"),
        mesh=lambda w: made(
            rules.mesh.output.mesh, structure=structures_of(CAMPAIGNS[w.campaign])[0]
        ),
    output:
        structure=report(
            "results/{campaign}/figures/structure.svg",
            caption="../report/structure.rst",
            category="{campaign}",
            subcategory="simulation",
        ),
        maps=report(
            "results/{campaign}/figures/maps.svg",
            caption="../report/maps.rst",
            category="{campaign}",
            subcategory="contact stiffness",
        ),
        joint=report(
            "results/{campaign}/figures/joint.svg",
            caption="../report/joint.rst",
            category="{campaign}",
            subcategory="contact stiffness",
        ),
        tractions=report(
            "results/{campaign}/figures/tractions.svg",
            caption="../report/tractions.rst",
            category="{campaign}",
            subcategory="contact theory",
        ),
        against_normal_force=report(
            "results/{campaign}/figures/against_normal_force.svg",
            caption="../report/against_normal_force.rst",
            category="{campaign}",
            subcategory="contact theory",
        ),
        compared=report(
            "results/{campaign}/figures/compared.svg",
            caption="../report/compared.rst",
            category="{campaign}",
            subcategory="contact theory",
        ),
    log:
        "results/logs/figures/{campaign}.log",
    benchmark:
        "results/benchmarks/figures/{campaign}.tsv"
    threads: 1
    resources:
        **needs("figures"),
    params:
        folder=folder_of_output,
        simulated=lambda w: int(CAMPAIGNS[w.campaign].simulated),
        code=code("figures"),
    message:
        "figures of {wildcards.campaign}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/figures.py --searches {input.searches:q}"
        " --stiffness {input.stiffness:q} --joints {input.joints:q} --theory {input.theory:q}"
        " --published {input.published:q} --mesh {input.mesh:q} --simulated {params.simulated}"
        " --folder {params.folder:q} > {log} 2>&1"


rule figures_thesis_search:
    input:
        searches=thesis_searches,
        published=given(ROOT / "resources" / "thesis" / "table_5_2.csv"),
    output:
        solution_sets=report(
            "results/{campaign}/figures/solution_sets.svg",
            caption="../report/solution_sets.rst",
            category="{campaign}",
            subcategory="contact stiffness",
        ),
        thesis_search=report(
            "results/{campaign}/figures/thesis_search.svg",
            caption="../report/thesis_search.rst",
            category="{campaign}",
            subcategory="contact stiffness",
        ),
    log:
        "results/logs/figures_thesis_search/{campaign}.log",
    benchmark:
        "results/benchmarks/figures_thesis_search/{campaign}.tsv"
    threads: 1
    resources:
        **needs("figures_thesis_search"),
    params:
        folder=folder_of_output,
        code=code("figures_thesis_search"),
    message:
        "figures 5.11 to 5.18 for {wildcards.campaign}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/figures_thesis_search.py --searches {input.searches:q}"
        " --published {input.published:q} --folder {params.folder:q} > {log} 2>&1"


rule figures_diagnosis:
    input:
        diagnoses=diagnoses,
        verdicts=verdicts,
    output:
        ranking=report(
            "results/{campaign}/figures/diagnosis_ranking.svg",
            caption="../report/diagnosis_ranking.rst",
            category="{campaign}",
            subcategory="diagnosis",
        ),
        frequencies=report(
            "results/{campaign}/figures/diagnosis_frequencies.svg",
            caption="../report/diagnosis_frequencies.rst",
            category="{campaign}",
            subcategory="diagnosis",
        ),
        curves=report(
            "results/{campaign}/figures/diagnosis_curves.svg",
            caption="../report/diagnosis_curves.rst",
            category="{campaign}",
            subcategory="diagnosis",
        ),
        residuals=report(
            "results/{campaign}/figures/diagnosis_residuals.svg",
            caption="../report/diagnosis_residuals.rst",
            category="{campaign}",
            subcategory="diagnosis",
        ),
        residual_maps=report(
            "results/{campaign}/figures/diagnosis_residual_maps.svg",
            caption="../report/diagnosis_residual_maps.rst",
            category="{campaign}",
            subcategory="diagnosis",
        ),
        law=report(
            "results/{campaign}/figures/diagnosis_law.svg",
            caption="../report/diagnosis_law.rst",
            category="{campaign}",
            subcategory="diagnosis",
        ),
    log:
        "results/logs/figures_diagnosis/{campaign}.log",
    benchmark:
        "results/benchmarks/figures_diagnosis/{campaign}.tsv"
    threads: 1
    resources:
        **needs("figures_diagnosis"),
    params:
        folder=folder_of_output,
        simulated=lambda w: int(CAMPAIGNS[w.campaign].simulated),
        code=code("figures_diagnosis"),
    message:
        "figures of what the simulation of {wildcards.campaign} gets wrong"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/figures_diagnosis.py --diagnoses {input.diagnoses:q}"
        " --verdicts {input.verdicts:q} --simulated {params.simulated}"
        " --folder {params.folder:q} > {log} 2>&1"


def report_facts(wildcards):
    """What the report says of the campaign besides its artifacts."""
    campaign = CAMPAIGNS[wildcards.campaign]
    return canonical_json(
        {
            "campaign": campaign.name,
            "description": campaign.description,
            "structures": structures_of(campaign),
            "simulated": campaign.simulated,
            "excluded": campaign.excluded,
            "entry": "records" if campaign.records else "stick frequencies",
        }
    )


def calibrations_made(wildcards):
    """Calibrations of the campaign's structures that exist: they are made when asked for."""
    possible = made(
        rules.calibrate.output.calibration,
        structure=structures_of(CAMPAIGNS[wildcards.campaign]),
    )
    return [path for path in possible if Path(path).is_file()]


rule report:
    input:
        stick=rules.stick.output.stick,
        fe_forces=with_structure(rules.fe_forces.output.fe_forces),
        stiffness=with_structure(rules.stiffness.output.stiffness),
        joints=joints,
        diagnoses=diagnoses,
        verdicts=verdicts,
        extended=extended_joints,
        main_verdict=rules.verdict.output.verdict,
        diagnosed=rules.figures_diagnosis.output,
        amplitudes=amplitudes,
        amplitudes_drawn=lambda w: (
            made(rules.figures_amplitude.output, **w) if amplitudes(w) else []
        ),
        shortfalls=lambda w: made(
            rules.shortfall.output.shortfall,
            structure=structures_of(CAMPAIGNS[w.campaign]),
        ),
        thesis_searches=thesis_searches,
        searched=lambda w: (
            made(rules.figures_thesis_search.output, **w) if thesis_searches(w) else []
        ),
        theory=with_structure(rules.theory.output.theory),
        checks=lambda w: made(
            rules.checks.output.checks, structure=structures_of(CAMPAIGNS[w.campaign])
        ),
        accuracies=lambda w: made(
            rules.accuracy.output.accuracy,
            structure=structures_of(CAMPAIGNS[w.campaign]),
        ),
        calibrations=calibrations_made,
        stick_drawn=rules.figures_stick.output.stick,
        figures=with_structure(rules.figures.output),
        modes=lambda w: made(
            rules.shapes.output.modes,
            # mode shapes are drawn on elements, which given matrices do not have
            structure=[
                name
                for name in structures_of(CAMPAIGNS[w.campaign])[:1]
                if name not in MATRICES
            ],
        ),
        drawn=lambda w: (
            made(rules.figures_records.output, **w)
            if CAMPAIGNS[w.campaign].records
            else []
        ),
        integrity=lambda w: (
            made(rules.integrity.output.integrity, **w)
            if CAMPAIGNS[w.campaign].records
            else []
        ),
        curves=lambda w: (
            made(rules.curves.output.curves, **w)
            if CAMPAIGNS[w.campaign].records
            else []
        ),
        score=lambda w: (
            made(rules.score.output.score, **w)
            if CAMPAIGNS[w.campaign].simulated
            else []
        ),
        ledger=lambda w: (
            made(rules.ledger.output.ledger, **w)
            if of_the_thesis(CAMPAIGNS[w.campaign])
            else []
        ),
        slider=lambda w: (
            made(rules.figures_slider.output.slider, **w)
            if of_the_thesis(CAMPAIGNS[w.campaign])
            else []
        ),
        thesis=given(
            expand(
                ROOT / "resources" / "thesis" / "{name}",
                name=["table_5_1.csv", "errata.yaml"],
            )
        ),
        page=given(
            expand(
                ROOT / "workflow" / "bladeroot" / "report" / "page.{ending}",
                ending=["html.j2", "css"],
            )
        ),
    output:
        report=report(
            "results/{campaign}/report.html",
            caption="../report/report.rst",
            category="{campaign}",
            subcategory="report",
        ),
    log:
        "results/logs/report/{campaign}.log",
    benchmark:
        "results/benchmarks/report/{campaign}.tsv"
    threads: 1
    resources:
        **needs("report"),
    params:
        results=folder_of_output,
        facts=report_facts,
        code=code("report"),
    message:
        "report of {wildcards.campaign}"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/report.py --results {params.results:q}"
        " --checks {input.checks:q} --accuracies {input.accuracies:q}"
        " --calibrations {input.calibrations:q} --joints {input.joints:q}"
        " --diagnoses {input.diagnoses:q} --verdicts {input.verdicts:q}"
        " --extended {input.extended:q}"
        " --amplitudes {input.amplitudes:q} --shortfalls {input.shortfalls:q}"
        " --figures {input.figures:q} {input.stick_drawn:q} {input.diagnosed:q} {input.modes:q} {input.drawn:q}"
        " {input.searched:q}"
        " {input.amplitudes_drawn:q} {input.slider:q}"
        " --thesis {input.thesis:q}"
        " --facts {params.facts:q}"
        " --output {output.report} > {log} 2>&1"
