"""A report as a file: HTML that loads nothing from elsewhere, or Markdown with PNGs beside it."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import quote

from cranktopo.base.companion import ALONE, Companion, Work
from cranktopo.base.files import write_bytes, write_text
from cranktopo.report.drafting import INK, STEEL, THIN
from cranktopo.report.page import Fact, Page, Section
from cranktopo.report.plot import DrawnPicture, Picture, png, save_figure
from cranktopo.report.result_table import escaped, markdown
from cranktopo.report.typeset import typeset, unbroken
from cranktopo.report.viewer.scene3d import SCRIPT, packed
from cranktopo.runs.destination import check_file

if TYPE_CHECKING:
    from jinja2 import Template

TEMPLATES = Path(__file__).parent / "template"
# Colours of plots and drawings that follow the theme of the page.
_CURVES = (
    ("#1f77b4", "#1f6fb4"),
    ("#ff7f0e", "#d1632a"),
    ("#2ca02c", "#2c8c4f"),
    ("#d62728", "#d0482b"),
    ("#9467bd", "#8a4fa3", "#7a5195"),
    ("#8c564b",),
    ("#e377c2",),
    ("#7f7f7f",),
    ("#bcbd22",),
    ("#17becf",),
)
_THEME = {colour: f"var(--c{number})" for number, found in enumerate(_CURVES) for colour in found} | {
    INK: "currentColor",
    THIN: "var(--muted)",
    STEEL: "var(--steel)",
    "#c7c7c7": "var(--steel)",
    "#000000": "currentColor",
    "#ffffff": "var(--panel)",
    "#e6e6e6": "var(--line)",
    "#cccccc": "var(--line)",
    "#b0b0b0": "var(--muted)",
    "#bfbfbf": "var(--muted)",
    "#999999": "var(--muted)",
    "#808080": "var(--muted)",
    "#737373": "var(--muted)",
    "#595959": "var(--muted)",
}


Drawn = Mapping[str, str]
"""Plots as SVG by their names."""


def html(page: Page, beside: Companion = ALONE, ahead: Sequence[Work[Drawn]] = ()) -> str:
    """Return the report as the text of an HTML file.

    Args:
        beside: draws the plots.
        ahead: of those that are drawn already, or nearly.
    """
    from markupsafe import Markup

    drawn = {name: text for work in ahead for name, text in work().items()}
    plots = [p for section in page.sections for p in section.pictures if not p.raster]
    others = beside.begin(drawn_plots, [plot for plot in plots if plot.name not in drawn])
    return _template().render(
        page=page,
        style=Markup((TEMPLATES / "report.css").read_text(encoding="utf-8")),
        script=Markup(SCRIPT.read_text(encoding="utf-8")),
        scene3d=Markup(packed(page.scene3d)) if page.scene3d else "",
        still=Markup(_inline_png(page.picture)) if page.picture else "",
        drawings={name: Markup(text) for name, text in {**_rasters(page), **drawn, **others()}.items()},
        version=metadata.version("cranktopo"),
        word=_WORD,
    )


@cache
def _template() -> Template:
    """Return the compiled template of a report, for all pages of this process."""
    from jinja2 import Environment, FileSystemLoader

    environment = Environment(loader=FileSystemLoader(TEMPLATES), autoescape=True)
    environment.filters |= {"typeset": typeset, "unit": unbroken, "name": _name, "prose": _prose}
    return environment.get_template("report.html.j2")


def _prose(text: str) -> str:
    """Return a text as HTML: typeset, what stands between backticks as code, options on one line."""
    from markupsafe import Markup, escape

    found = _OPTION.sub(r'<span class="word">\g<0></span>', str(escape(typeset(text))))
    return Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", found))


def _name(text: str) -> str:
    """Return the name of a row as HTML, which has little room.

    A long key of a scene may go on in the next line behind any part, a number in front of its unit.
    """
    from markupsafe import Markup, escape

    found = _IN_FRONT_OF_UNIT.sub(" ", str(escape(typeset(text))))
    broken = len(text) > _WORD and _KEY.fullmatch(text)
    return Markup(re.sub(r"(?<=\w)([._])(?=\w)", r"\1<wbr>", found) if broken else found)


_WORD = 16
"""Letters of a cell that stays on one line."""
_KEY = re.compile(r"[\w.\[\]-]*[._][\w.\[\]-]*")
_OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]*")
_IN_FRONT_OF_UNIT = re.compile(r"(?<=\d)\u00a0(?=[^\W\d])")


def _inline_png(picture: Picture | DrawnPicture) -> str:
    content = picture.png if isinstance(picture, DrawnPicture) else png(picture.figure)
    data = base64.b64encode(content).decode("ascii")
    return f'<img src="data:image/png;base64,{data}" alt="{_attribute(picture.alt)}">'


def _rasters(page: Page) -> Drawn:
    return {p.name: _inline_png(p) for section in page.sections for p in section.pictures if p.raster}


def drawn_plots(pictures: Sequence[Picture]) -> Drawn:
    """Draw plots for `html`, in any process."""
    return {picture.name: _inline_svg(picture) for picture in pictures}


def _inline_svg(picture: Picture) -> str:
    """Return the plot as SVG for the body of a page: text as text, greys of the theme, no size of its own."""
    import matplotlib as mpl

    stream = io.StringIO()
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": picture.name}):
        save_figure(picture.figure, stream, format="svg", metadata={"Date": None, "Creator": None})
    text = stream.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r' width="[^"]*pt"| height="[^"]*pt"| xmlns[:a-z]*="[^"]*"', "", text, count=4)
    text = re.sub(r'<g id="[^"]*"', "<g", text)
    text = re.sub(r"font: (\d[\d.]*px) [^;\"]*", r"font-size: \1; font-family: inherit", text)
    for grey, colour in _THEME.items():
        text = text.replace(grey, colour)
    return text.replace("<svg", f'<svg role="img" aria-label="{_attribute(picture.alt)}"', 1)


def _attribute(text: str) -> str:
    from markupsafe import escape

    return str(escape(text))


_DPI = 150


def write_markdown(page: Page, path: Path) -> None:
    """Write the report to a .md file, its plots in the folder `<name>-pictures` beside it."""
    folder = path.with_name(f"{path.stem}-pictures")
    folder.mkdir(exist_ok=True)
    for picture in _pictures(page):
        content = picture.png if isinstance(picture, DrawnPicture) else png(picture.figure, _DPI, "white")
        write_bytes(folder / f"{picture.name}.png", content)
    write_text(path, markdown_text(page, folder.name))


def markdown_text(page: Page, folder: str) -> str:
    """Return the report as Markdown, its plots in a folder relative to the text."""
    blocks = [f"# {escaped(page.title)}", escaped(page.subtitle), f"**{escaped(page.headline)}**"]
    blocks.append("\n".join(_fact(fact) for fact in page.verdict))
    if page.picture:
        blocks.append(_image(page.picture, folder))
    blocks += [block for section in page.sections for block in _section(section, folder)]
    return "\n\n".join(blocks) + "\n"


def _pictures(page: Page) -> list[Picture | DrawnPicture]:
    stills = [page.picture] if page.picture else []
    return [*stills, *(picture for section in page.sections for picture in section.pictures)]


def _fact(fact: Fact) -> str:
    return f"- {escaped(fact.label)}: **{escaped(fact.value)}** ({escaped(fact.note)})"


def _section(section: Section, folder: str) -> list[str]:
    blocks = [f"## {escaped(section.title)}", *map(escaped, section.paragraphs)]
    for caption, table in section.tables:
        blocks += [f"{escaped(caption)}:", markdown(table)]
    return blocks + [_image(picture, folder) for picture in section.pictures]


def _image(picture: Picture | DrawnPicture, folder: str) -> str:
    return f"![{escaped(picture.alt)}]({quote(folder)}/{quote(picture.name)}.png)"


REPORT = "report.html"
_SUFFIXES = (".html", ".md")


def check_report_path(path: Path) -> None:
    """Check, before long work, that a report can go there; raises CranktopoError."""
    check_file(path, "report", _SUFFIXES)


def write_report(
    page: Page, path: Path, beside: Companion = ALONE, ahead: Sequence[Work[Drawn]] = ()
) -> None:
    """Write a report as HTML or Markdown, by the ending of its name; replaced only when it is complete.

    Plots of HTML are drawn as in `html`.
    """
    check_report_path(path)
    if path.suffix.lower() == ".md":
        write_markdown(page, path)
    else:
        write_text(path, html(page, beside, ahead))
