"""A wheel carries the shipped settings and structures, which a checkout has beside the library."""

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

SHIPPED = ("config/config.yaml", "resources/structures/*.yaml")


class WithShipped(build_py):
    """Copies them to where `bladeroot.shipped_files` looks first."""

    def run(self):
        """Build as always, then copy."""
        super().run()
        if self.editable_mode:
            return
        here = Path(__file__).resolve().parent
        for pattern in SHIPPED:
            for file in here.glob(pattern):
                place = Path(self.build_lib, "bladeroot", "shipped", file.relative_to(here))
                place.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(file, place)


setup(cmdclass={"build_py": WithShipped})
