"""A report as Markdown with PNGs beside it, for a thesis or a merge request."""

from __future__ import annotations

from pathlib import Path

from cranktopo.report.figures.plot import Picture
from cranktopo.report.figures.png import png
from cranktopo.report.pages.page import Page, Section
from cranktopo.report.tables.result_table import markdown
from cranktopo.store import write_bytes, write_text

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
    """The report as Markdown.

    Args:
        folder: where the plots are, relative to the text.
    """
    blocks = [f"# {page.title}", page.subtitle, f"**{page.headline}**"]
    blocks.append("\n".join(f"- {fact.label}: **{fact.value}** ({fact.note})" for fact in page.facts))
    if page.picture:
        blocks.append(_image(page.picture, folder))
    blocks += [block for section in page.sections for block in _section(section, folder)]
    return "\n\n".join(blocks) + "\n"


def _pictures(page: Page) -> list[Picture]:
    stills = [page.picture] if page.picture else []
    return stills + [picture for section in page.sections for picture in section.pictures]


def _section(section: Section, folder: str) -> list[str]:
    blocks = [f"## {section.title}", *([section.text] if section.text else [])]
    for caption, table in section.tables:
        blocks += [f"{caption}:", markdown(table)]
    return blocks + [_image(picture, folder) for picture in section.pictures]


def _image(picture: Picture, folder: str) -> str:
    alt = picture.alt.replace("[", "(").replace("]", ")")
    return f"![{alt}]({folder}/{picture.name}.png)"
