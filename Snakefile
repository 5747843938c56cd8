# Target rules and includes, nothing else. Every stage is a file of workflow/rules/.
from snakemake.utils import min_version

min_version("9.27")


configfile: f"{workflow.basedir}/config/config.yaml"


include: "workflow/rules/common.smk"
include: "workflow/rules/tell.smk"
include: "workflow/rules/resources.smk"
include: "workflow/rules/warm.smk"


rule all:
    input:
        expand("results/{campaign}/report.html", campaign=CAMPAIGNS),


include: "workflow/rules/structure.smk"
include: "workflow/rules/calibrate.smk"
include: "workflow/rules/parametric.smk"
include: "workflow/rules/matrices.smk"
include: "workflow/rules/assembly.smk"
include: "workflow/rules/bench.smk"
include: "workflow/rules/ringdown.smk"
include: "workflow/rules/curves.smk"
include: "workflow/rules/integrity.smk"
include: "workflow/rules/stick.smk"
include: "workflow/rules/fe_forces.smk"
include: "workflow/rules/stiffness.smk"
include: "workflow/rules/amplitude.smk"
include: "workflow/rules/diagnosis.smk"
include: "workflow/rules/theory.smk"
include: "workflow/rules/nonlinear.smk"
include: "workflow/rules/extended.smk"
include: "workflow/rules/ledger.smk"
include: "workflow/rules/report.smk"
include: "workflow/rules/export_tables.smk"
# Last: what is refused leaves nothing behind.
include: "workflow/rules/current.smk"


onstart:
    if RUN:
        RUN.started()


onsuccess:
    STATED.state_rest()
    tell_results()


onerror:
    STATED.state_rest()
    tell_failures(log)
