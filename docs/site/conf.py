"""Settings of the documentation site; `make site` builds it (see `make.py` beside this file)."""

import gc
import sys
from pathlib import Path

import numba
from sphinx.domains.python import PythonDomain

gc.set_threshold(100_000)  # pages are trees of small objects, and none is garbage before its page is done

sys.path.insert(0, str(Path(__file__).parent))

from docstrings import setup as docstrings_setup

# ---------------------------------------------------------------------------------------- compiled functions


def _plain(*args, **_options):
    """Stand in for `numba.njit`: keep a function as it is, with its signature and docstring."""

    def keep(function):
        function.py_func = function
        return function

    return keep(args[0]) if args and callable(args[0]) else keep


numba.njit = _plain
numba.config.DISABLE_JIT = 1  # here alone: the kernels of the notebooks compile

import ryusa

# --------------------------------------------------------------------------------------------------- content

project = "ryusa"
author = "The ryusa developers"
copyright = "2026, the ryusa developers"
version = release = ryusa.__version__
root_doc = "index"
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "numpydoc",
    "sphinx.ext.viewcode",
    "sphinx_design",
    "languages",
]
myst_enable_extensions = ["colon_fence", "deflist", "attrs_inline"]
myst_heading_anchors = 4
nb_execution_mode = "force"  # what a notebook shows is what this ryusa gives
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True
default_role = "code"
smartquotes = False  # options such as --set, and quotes in commands, must be copied as they are typed
nitpicky = True
# Only names of ryusa have pages here; types of Python, NumPy and other packages are shown without a link.
nitpick_ignore_regex = [(r"py:.*", r"(?!ryusa\.).*")]

# ------------------------------------------------------------------------------------------------- reference

autodoc_use_type_comments = False  # there are none, and every source would be searched for them
autosummary_generate = False  # numpydoc brings it along; no page has its tables
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
python_use_unqualified_type_names = True
python_display_short_literal_types = True
add_module_names = False
numpydoc_show_class_members = False
numpydoc_xref_param_type = False
maximum_signature_line_length = 90
toc_object_entries_show_parents = "hide"

# ------------------------------------------------------------------------------------------------------ look

html_theme = "pydata_sphinx_theme"
html_title = "ryusa"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {
    "logo": {"text": "ryusa 流砂"},
    "header_links_before_dropdown": 9,
    "collapse_navigation": True,  # otherwise every page holds the tree of all modules
    "navigation_depth": 3,
    "show_nav_level": 1,
    "show_toc_level": 2,
    "navbar_align": "left",
    "navbar_end": ["theme-switcher"],
    "navbar_persistent": ["search-button"],
    "footer_start": ["copyright"],
    "footer_end": ["theme-version"],
    "secondary_sidebar_items": ["page-toc"],
}
html_sidebars = {"index": [], "getting-started": [], "gallery": [], "glossary": [], "theory": [], "ja/*": []}


class KnownNames(PythonDomain):
    """Names of Python, of which those that end like none of ryusa's are not compared with each of these."""

    _ends: frozenset[str] = frozenset()
    _of = 0  # objects from which `_ends` was made

    def find_obj(self, env, modname, classname, name, type, searchmode=0):
        """As in Sphinx, which looks for float and Path in all ten thousand names on every page."""
        if self._of != len(self.objects):
            self._of = len(self.objects)
            self._ends = frozenset(one.rpartition(".")[2] for one in self.objects)
        if name.removesuffix("()").rpartition(".")[2] not in self._ends:
            return []
        return super().find_obj(env, modname, classname, name, type, searchmode)


FIRST = ("study-grows-notebook", "bedload-notebook")  # longest, and one compiles the kernels of both


def notebooks_first(_app, _env, names):
    """Read the pages that take longest first, one after the other, while other pages are read beside them."""
    names.sort(key=lambda name: FIRST.index(name) if name in FIRST else len(FIRST))


def name_toggles(_app, _page, _template, context, _doctree):
    """Name the arrows that fold and unfold the navigation, which have no words in the theme."""
    make = context["generate_toctree_html"]

    def named(*args, **options):
        found = make(*args, **options)
        if not isinstance(found, str):
            for arrow in found.select("li > details > summary"):
                arrow["aria-label"] = f"pages of {arrow.find_parent('li').a.get_text()}"
        return found

    context["generate_toctree_html"] = named


def setup(app):
    """Connect what turns the docstrings of ryusa into what numpydoc reads, the order of pages and names."""
    docstrings_setup(app)
    app.add_domain(KnownNames, override=True)
    app.connect("env-before-read-docs", notebooks_first)
    app.connect("html-page-context", name_toggles, priority=900)  # after those of the theme
