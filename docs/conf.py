"""The manual: `python -m sphinx -W docs OUT`, with the extra `docs`; `-t quick` leaves the figures out."""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE)]

import generated  # noqa: E402  # pages generated from the program

import frictionmap  # noqa: E402

generated.write(HERE / "reference")

project = "frictionmap"
author = "The frictionmap authors"
copyright = "the frictionmap authors; MIT licence"
version = release = frictionmap.__version__

extensions = [
    "myst_parser", "sphinx.ext.autodoc", "sphinx.ext.autosummary", "sphinx.ext.napoleon",
    "sphinx_gallery.gen_gallery",
]  # fmt: skip
exclude_patterns = ["_build", "gallery/*"]
suppress_warnings = ["config.cache"]  # the settings of the gallery cannot be pickled
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
smartquotes = False  # keep "--set" and quotes as they are, for copying

autosummary_generate = False  # `generated` writes the pages of its tables
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings give them, with shapes, units and ranges
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
napoleon_preprocess_types = False

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "figures",
    "filename_pattern": "/plot_",
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "remove_config_comments": True,
    "download_all_examples": False,
    "show_memory": False,
    "capture_repr": (),  # do not print the axes of a picture as a result
    "write_computation_times": False,  # its pages load scripts from other sites
    "min_reported_time": 1,
    "image_scrapers": ("matplotlib",),
    "plot_gallery": not tags.has("quick"),  # noqa: F821  # defined by Sphinx
}

html_theme = "furo"
html_title = f"frictionmap {release}"
html_theme_options = {"navigation_with_keys": True}
html_show_sphinx = False
html_copy_source = False
html_static_path = ["static"]
html_css_files = ["print.css"]

html_math_renderer = "mathml"


def setup(app: object) -> None:
    """Formulas as MathML, which browsers show without a script or a font from elsewhere."""
    from docutils.nodes import SkipNode
    from latex2mathml.converter import convert

    def show(display: str) -> tuple:
        def visit(writer: object, node: object) -> None:
            formula = convert(node.astext(), display=display)
            # a formula wider than a small window scrolls by itself; the page does not
            scrolls = '<div class="math" tabindex="0" style="overflow-x: auto; overflow-y: hidden">'
            writer.body.append(f"{scrolls}{formula}</div>" if display == "block" else formula)
            raise SkipNode

        return visit, None

    app.add_html_math_renderer("mathml", show("inline"), show("block"))
    app.connect("html-page-context", _accessible, priority=900)  # once the theme has made its navigation


def _accessible(app: object, page: str, template: str, context: dict, doctree: object) -> None:
    """Let the keyboard scroll what is wider than a small window; give captions of the contents a level."""
    for part in ("body", "furo_navigation_tree"):
        text = context.get(part) or ""
        for before, after in (
            ("<pre>", '<pre tabindex="0">'),
            ('<div class="table-wrapper', '<div tabindex="0" class="table-wrapper'),
            (' role="heading"', ' role="heading" aria-level="2"'),
        ):
            text = text.replace(before, after)
        context[part] = text
