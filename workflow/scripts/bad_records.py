"""What a run's end tells of a campaign's bad records: a line each."""

from _cli import run
from bladeroot import artifacts
from bladeroot.report.bad_records import bad_lines


def main(stick, integrity):
    for line in bad_lines(artifacts.load(stick), artifacts.load(integrity)):
        print(line)


if __name__ == "__main__":
    run(main, stick="stick.nc", integrity="integrity.nc")
