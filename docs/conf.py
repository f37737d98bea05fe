# SPDX-License-Identifier: BSD-3-Clause
"""How scripts/docs makes the pages (Sphinx, MyST). The pages themselves stay plain Markdown that any reader shows."""
import os
import pathlib
import re

HERE = pathlib.Path(__file__).parent
KATEX = pathlib.Path("/usr/share/javascript/katex")     # Debian's libjs-katex: formulas without a network

project = "straytrace"
copyright = "the straytrace authors, BSD-3-Clause"
release = re.search(r"straytrace VERSION ([\d.]+)", (HERE.parent / "CMakeLists.txt").read_text()).group(1)
extensions = ["myst_parser", "breathe"]
breathe_projects = {"straytrace": os.environ["STRAYTRACE_DOXYGEN"]}    # of the C++ library
breathe_default_project = "straytrace"
myst_enable_extensions = ["dollarmath"]
myst_dmath_double_inline = True
myst_heading_anchors = 5
html_theme = "furo"
html_title = f"straytrace {release}"
html_static_path = ["pages.css", str(KATEX)]
html_css_files = ["katex.min.css", "pages.css"]
mathjax_path = "katex.min.js"                            # in place of the page's only script from elsewhere
html_js_files = [("contrib/auto-render.js", {"defer": "defer"}),
                 (None, {"body": "addEventListener('load', () => renderMathInElement(document.body));"})]
html_copy_source = False
pygments_style = "friendly"

LINK = re.compile(r"\[([^]]*)\]\(([\w/.-]+)\.md\)")
LISTED = re.compile(r"^[|*] .*", re.MULTILINE)             # rows and items come before what the prose names
FENCE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


def contents(app, page, source):
    """The pages that an index page links, in its order, are the contents of its part."""
    if page.rpartition("/")[2] != "index":
        return
    here = pathlib.PurePosixPath(page).parent
    text = FENCE.sub("", source[0])
    linked = {}
    for title, link in LINK.findall("\n".join(LISTED.findall(text)) + text):
        linked.setdefault(link, title)
    own = [link for link in linked if not link.startswith("..") and str(here / link) != page]
    if page == "index":                                     # the four parts under their names
        own = [f"{linked[link]} <{link}>" for link in own if link.endswith("/index")]
    source[0] += "\n```{toctree}\n:hidden:\n:maxdepth: 2\n\n" + "\n".join(own) + "\n```\n"


def setup(app):
    app.connect("source-read", contents)
    return {"parallel_read_safe": True}
