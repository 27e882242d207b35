"""How is the documentation built? Sphinx with furo and MyST-NB;
``python -m sphinx -W --keep-going -b html docs build/docs`` in a clone.

Everything that a page needs is served with it (MathJax too), notebooks are run while it is built, and no
network is used.
"""

import os
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
sys.path.insert(0, str(ROOT / "docs"))
os.environ["SNOOKER_ENV_QUIET"] = "1"  # what is said of compiling belongs to no page
# for the kernels of notebooks
os.environ["PYTHONPATH"] = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
os.environ.setdefault("SDL_VIDEODRIVER", "dummy")

import snooker_env  # noqa: E402 - after the path

project = "snooker_env"
author = "the snooker_env authors"
copyright = "2026, the snooker_env authors"
version = release = snooker_env.__version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx-mathjax-offline",  # MathJax and its fonts come from here, not from a server
    "sphinx_copybutton",
    "_extensions.docstrings",
    "_extensions.public",
    "_extensions.repository_files",
]
exclude_patterns = ["_build", "_extensions", "films/README.md", "pictures/README.md", "**/.ipynb_checkpoints"]
suppress_warnings = [
    "myst-nb.lexer",  # of notebooks, where they are not run
    "ref.python",  # one name of a field, as "strokes", in several classes
]

# pages
myst_enable_extensions = [
    "amsmath",
    "attrs_block",
    "attrs_inline",
    "colon_fence",
    "deflist",
    "dollarmath",
    "fieldlist",
]
myst_heading_anchors = 4
myst_dmath_double_inline = True
math_number_all = False
numfig = True

# notebooks: run at every build, an error ends it
nb_execution_mode = "force"
nb_execution_timeout = 600
nb_execution_raise_on_error = True
nb_execution_show_tb = True
nb_output_stderr = "remove"
nb_merge_streams = True

# docstrings
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # numpy style says types, shapes and units in words
autodoc_preserve_defaults = True
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
add_module_names = False

# the site
html_theme = "furo"
html_title = f"snooker_env {release}"
html_static_path = ["_static", "../results/films"]
html_css_files = ["snooker.css"]
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#1b6b3a", "color-brand-content": "#1b6b3a"},
    "dark_css_variables": {"color-brand-primary": "#6fcf97", "color-brand-content": "#6fcf97"},
    "navigation_with_keys": True,
}
copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True
