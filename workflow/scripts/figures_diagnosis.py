"""Figures of the diagnosis: ranking of causes, measured against simulated before and after."""

from _cli import run
from bladeroot import artifacts
from bladeroot.figures import diagnosis, residual_maps
from bladeroot.figures.style import svg


def main(diagnoses, verdicts, simulated, folder):
    found = [artifacts.load(path) for path in diagnoses]
    said = [artifacts.load_json(path) for path in verdicts]
    made = bool(int(simulated))
    drawn = {
        "ranking": diagnosis.ranking(found, said, made),
        "frequencies": diagnosis.frequencies(found, made),
        "curves": diagnosis.curves(found, made),
        "residuals": residual_maps.records(found, made),
        "residual_maps": residual_maps.curves(found, made),
        "law": diagnosis.law(found, made),
    }
    for name, figure in drawn.items():
        artifacts.save_text(svg(figure), f"{folder}/diagnosis_{name}.svg")


if __name__ == "__main__":
    run(
        main,
        diagnoses="many: diagnosis with every structure, the main one first",
        verdicts="many: verdicts of the same structures (JSON)",
        simulated="1 if the records are simulated",
        folder="where the figures go",
    )
