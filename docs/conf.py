"""The documentation's site: `pip install -r docs/environment.txt`, `sphinx-build -W docs site`."""

import os
import sys
from pathlib import Path

# Tutorials run one after the other while the site is built.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "workflow"), str(HERE)]

import bladeroot  # noqa: E402

project = "bladeroot"
copyright = "the authors of bladeroot; BSD-3-Clause"
version = release = bladeroot.__version__
extensions = [
    "myst_parser",  # pages in Markdown
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_gallery.gen_gallery",  # tutorials that run, with a notebook of each
    "matplotlib.sphinxext.mathmpl",  # equations as pictures: readable offline, no LaTeX
    "reference",
]
myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 4
mathmpl_fontsize = 12.0
mathmpl_srcset = ["2x"]
exclude_patterns = ["environment.txt", "tutorials/README.rst"]
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # shapes and units stand in the text
sphinx_gallery_conf = {
    "examples_dirs": "tutorials",
    "gallery_dirs": "generated/tutorials",
    "filename_pattern": "/tutorial_",
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_signature": False,
    "write_computation_times": False,  # their table is of scripts from elsewhere
}
html_theme = "furo"
html_title = "bladeroot"
html_theme_options = {"source_repository": "", "sidebar_hide_name": False}
html_copy_source = False
# Files beside the pages' sources that a page of the clone links to.
suppress_warnings = ["config.cache"]
