# Sphinx reads this; scripts/docs runs it. The pages stay plain Markdown: what the site needs besides is added here.
import pathlib
import re
import xml.etree.ElementTree

DOCS = pathlib.Path(__file__).parent
DOXYGEN_XML = DOCS.parent / "build-docs" / "doxygen" / "xml"

project = "cbmv_stereo"
author = "cbmv_stereo maintainers"
version = release = re.search("<version>(.*)</version>", (DOCS.parent / "package.xml").read_text()).group(1)
extensions = ["myst_parser", "breathe"]
myst_heading_anchors = 4
html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_title = f"cbmv_stereo {version}"
html_show_sourcelink = False
html_show_copyright = False
highlight_language = "none"
breathe_projects = {"cbmv_stereo": str(DOXYGEN_XML)}
breathe_default_project = "cbmv_stereo"
breathe_default_members = ("members",)


def table_of_contents(index):
    """The reading order of the site: the links of each section of index.md."""
    trees = ""
    for section in index.split("\n## ")[1:]:
        caption, text = section.split("\n", 1)
        pages = re.findall(r"^\* \[.*?\]\((.*?)\.md\)", text, re.MULTILINE)
        trees += f"\n```{{toctree}}\n:hidden:\n:caption: {caption}\n\n" + "\n".join(pages) + "\n```\n"
    return trees


def directive(kind, name):
    members = "\n   :members:" if kind in ("struct", "class") else ""
    return f"\n```{{eval-rst}}\n.. doxygen{kind}:: {name}{members}\n```\n"


def members_of(header, compounds):
    """Classes, functions, enumerations, aliases and constants of a header, in the order of its lines."""
    found = []
    for compound in compounds:
        name, kind = compound.findtext("compoundname"), compound.get("kind")
        location = compound.find("location")
        if kind in ("struct", "class") and location.get("file") == header:
            found.append((int(location.get("line")), kind, name))
        for member in compound.iter("memberdef") if kind == "namespace" else ():
            location = member.find("location")
            if location.get("file") == header:
                types = ", ".join("".join(type_.itertext()) for type_ in member.findall("param/type"))
                parameters = f"({types})" if member.get("kind") == "function" else ""
                found.append((int(location.get("line")), member.get("kind"),
                              f"{name}::{member.findtext('name')}{parameters}"))
    return sorted(found)


def interfaces():
    """A section for each header that Doxygen has read."""
    index = xml.etree.ElementTree.parse(DOXYGEN_XML / "index.xml")
    compounds = [xml.etree.ElementTree.parse(DOXYGEN_XML / f"{entry.get('refid')}.xml").find("compounddef")
                 for entry in index.iter("compound")]
    headers = sorted(compound.find("location").get("file") for compound in compounds if compound.get("kind") == "file")
    nested = {inner.text for compound in compounds if compound.get("kind") in ("struct", "class")
              for inner in compound.iter("innerclass")}
    return "".join(f"\n## {header}\n" + "".join(directive(kind, name)
                                               for _, kind, name in members_of(header, compounds)
                                               if name not in nested)
                   for header in headers)


def extend_page(app, page, source):
    if page == "index":
        source[0] += table_of_contents(source[0])
    elif page == "api":
        source[0] += interfaces()


def setup(app):
    app.connect("source-read", extend_page)
