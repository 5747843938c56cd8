"""The thesis's model of one degree of freedom, its decay, and FREEVIB on it -> slider.nc."""

from _cli import run
from bladeroot import artifacts
from bladeroot.reproduction.one_dof import slider_curves


def main(campaign, output):
    artifacts.save(slider_curves().assign_attrs(campaign=campaign), output)


if __name__ == "__main__":
    run(main, campaign="the campaign's name", output="slider.nc")
