# Unpublished dimensions from published tables. It takes minutes a structure, so nothing asks for it but
# `snakemake -j1 calibrations`; what is made once is kept up to date and stands in the reports.

CALIBRATION = ROOT / "resources" / "structures" / "calibration"


rule calibrate:
    input:
        asked=given(CALIBRATION / "{structure}.yaml"),
        structure=structure_file,
        tables=given(
            expand(
                ROOT / "resources" / "thesis" / "table_{table}.csv",
                table=["2_2", "3_1", "3_2", "4_1", "4_2", "4_3", "4_4", "5_1", "5_2"],
            )
        ),
    output:
        calibration="results/structures/{structure}/calibration.nc",
    log:
        "results/logs/calibrate/{structure}.log",
    benchmark:
        "results/benchmarks/calibrate/{structure}.tsv"
    threads: 1
    resources:
        **needs("calibrate"),
    params:
        code=code("calibrate"),
    message:
        "unpublished dimensions of {wildcards.structure} from the thesis's tables"
    shell:
        "{PYTHON:q} {SCRIPTS:q}/calibrate.py --calibration_file {input.asked:q}"
        " --structure {input.structure:q} --tables {input.tables:q}"
        " --output {output.calibration} > {log} 2>&1"


rule calibrations:
    input:
        [
            f"results/structures/{name}/calibration.nc"
            for name in sorted(STRUCTURES)
            if (CALIBRATION / f"{name}.yaml").is_file()
        ],
