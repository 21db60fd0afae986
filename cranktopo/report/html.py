"""A report as one HTML file: nothing is loaded from anywhere else."""

from __future__ import annotations

import base64
import io
import re
from importlib import metadata
from pathlib import Path

from cranktopo.report.page import Page
from cranktopo.report.plot import Picture
from cranktopo.report.png import png
from cranktopo.report.viewer.scene3d import SCRIPT, packed

TEMPLATES = Path(__file__).parent / "template"
# Greys of the plots that follow the theme of the page.
_THEME = {
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


def html(page: Page) -> str:
    """Return the report as the text of an HTML file."""
    from jinja2 import Environment, FileSystemLoader
    from markupsafe import Markup

    environment = Environment(loader=FileSystemLoader(TEMPLATES), autoescape=True)
    return environment.get_template("report.html.j2").render(
        page=page,
        style=Markup((TEMPLATES / "report.css").read_text(encoding="utf-8")),
        script=Markup(SCRIPT.read_text(encoding="utf-8")),
        scene3d=Markup(packed(page.scene3d)) if page.scene3d else "",
        still=Markup(_inline_png(page.picture)) if page.picture else "",
        drawings={p.name: Markup(_drawing(p)) for section in page.sections for p in section.pictures},
        version=metadata.version("cranktopo"),
    )


def _drawing(picture: Picture) -> str:
    return _inline_png(picture) if picture.raster else _inline_svg(picture)


def _inline_png(picture: Picture) -> str:
    data = base64.b64encode(png(picture.figure)).decode("ascii")
    return f'<img src="data:image/png;base64,{data}" alt="{_attribute(picture.alt)}">'


def _inline_svg(picture: Picture) -> str:
    """Return the plot as SVG for the body of a page: text as text, greys of the theme, no size of its own."""
    import matplotlib as mpl

    stream = io.StringIO()
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": picture.name}):
        picture.figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
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
