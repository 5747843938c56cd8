"""From ring-down records of a blade-root joint to contact stiffness (see README.md)."""

from importlib.metadata import version

__version__ = version("bladeroot")
