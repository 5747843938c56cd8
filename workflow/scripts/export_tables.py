"""Curves, stick frequencies and verdict of a campaign as CSV, MATLAB and universal file."""

from _cli import run
from bladeroot.files import whole_folder
from bladeroot.public.export import export


def main(results, folder):
    with whole_folder(folder) as part:
        export(results, part)


if __name__ == "__main__":
    run(main, results="the campaign's folder in results/", folder="where the files go")
