"""Files that the page has written, each by a command of the command line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Written:
    """A kind of file.

    Attributes:
        ending: what follows the name of the design.
        words: the command: {design} is what is written, {original} what it is compared with, {file} the file.
        printed: whether the command prints what the file holds.
    """

    ending: str
    words: tuple[str, ...]
    printed: bool = False

    @property
    def compares(self) -> bool:
        """True where the original is read as well."""
        return any("{original}" in word for word in self.words)

    def line(self, design: str, original: str, file: str) -> list[str]:
        """Return the command with these files, without redirection."""
        return [word.format(design=design, original=original, file=file) for word in self.words]


def _solid(part: str) -> tuple[str, ...]:
    return ("export", "{design}", "{file}", "--force", f"--part={part}")


_COMPARED = ("compare", "{original}", "{design}", "--baseline={original}", "--no-bound", "--fatigue=lsa")
WRITTEN: Mapping[str, Written] = {
    "step-throw": Written(".step", _solid("throw")),
    "step-web": Written("-web.step", _solid("web")),
    "step-crank": Written("-crank.step", _solid("crankshaft")),
    "stl": Written(".stl", _solid("throw")),
    "drawing-pdf": Written(".pdf", ("export", "{design}", "{file}", "--force")),
    "drawing-svg": Written(".svg", ("export", "{design}", "{file}", "--force")),
    "m53": Written("-m53.pdf", ("fatigue", "{design}", "--method=m53", "--report={file}")),
    "vibration": Written("-vibration.html", ("vibration", "{design}", "--report={file}")),
    "compare": Written("-compare.html", (*_COMPARED, "--report={file}")),
    "table": Written("-table.md", (*_COMPARED, "--format=markdown"), printed=True),
}
ENDINGS = tuple({f".{kind.ending.rpartition('.')[2]}": None for kind in WRITTEN.values()})
