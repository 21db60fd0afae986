"""A report as Markdown with PNGs beside it, for a thesis or a merge request."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import quote

from cranktopo.base.files import write_bytes, write_text
from cranktopo.report.page import Fact, Page, Section
from cranktopo.report.plot import Picture
from cranktopo.report.png import png
from cranktopo.report.result_table import escaped, markdown

_DPI = 150


def write_markdown(page: Page, path: Path) -> None:
    """Write the report, its plots in the folder `<name>-pictures` beside it.

    Args:
        path: the .md file; its folder exists.

    Raises:
        CranktopoError: a file cannot be written.
    """
    folder = path.with_name(f"{path.stem}-pictures")
    folder.mkdir(exist_ok=True)
    for picture in _pictures(page):
        write_bytes(folder / f"{picture.name}.png", png(picture.figure, _DPI, "white"))
    write_text(path, markdown_text(page, folder.name))


def markdown_text(page: Page, folder: str) -> str:
    """Return the report as Markdown.

    Args:
        folder: where the plots are, relative to the text.
    """
    blocks = [f"# {escaped(page.title)}", escaped(page.subtitle), f"**{escaped(page.headline)}**"]
    blocks.append("\n".join(_fact(fact) for fact in page.facts))
    if page.picture:
        blocks.append(_image(page.picture, folder))
    blocks += [block for section in page.sections for block in _section(section, folder)]
    return "\n\n".join(blocks) + "\n"


def _pictures(page: Page) -> list[Picture]:
    stills = [page.picture] if page.picture else []
    return stills + [picture for section in page.sections for picture in section.pictures]


def _fact(fact: Fact) -> str:
    return f"- {escaped(fact.label)}: **{escaped(fact.value)}** ({escaped(fact.note)})"


def _section(section: Section, folder: str) -> list[str]:
    blocks = [f"## {escaped(section.title)}", *([escaped(section.text)] if section.text else [])]
    for caption, table in section.tables:
        blocks += [f"{escaped(caption)}:", markdown(table)]
    return blocks + [_image(picture, folder) for picture in section.pictures]


def _image(picture: Picture, folder: str) -> str:
    return f"![{escaped(picture.alt)}]({quote(folder)}/{quote(picture.name)}.png)"
