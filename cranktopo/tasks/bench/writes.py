"""Files that the page has written, each by a command of the command line."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import write_bytes
from cranktopo.base.line_width import unfolded
from cranktopo.tasks.bench.jobs import PARTLY, own_command

_LONGEST_S = 900.0


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
    "drawing-crank": Written("-crank.pdf", ("drawing", "{design}", "{file}", "--force")),
    "step-rod": Written("-rod.step", _solid("rod")),
    "drawing-rod": Written("-rod.pdf", ("rod", "{design}", "--drawing={file}")),
    "step-balancer": Written("-balancer.step", _solid("balancer")),
    "drawing-balancer": Written("-balancer.pdf", ("balancer", "{design}", "--drawing={file}")),
    "m53": Written("-m53.pdf", ("fatigue", "{design}", "--method=m53", "--report={file}")),
    "vibration": Written("-vibration.html", ("vibration", "{design}", "--report={file}")),
    "vibration-misfire": Written(
        "-misfire.html", ("vibration", "{design}", "--misfire=1", "--report={file}")
    ),
    "modes": Written("-modes.html", ("modes", "{design}", "--report={file}")),
    "balance": Written("-balance.html", ("balance", "{design}", "--report={file}")),
    "loads": Written("-loads.csv", ("loads", "{design}", "--csv={file}")),
    "film": Written("-film.svg", ("film", "{design}", "--plot={file}")),
    "compare": Written("-compare.html", (*_COMPARED, "--report={file}")),
    "table": Written("-table.md", (*_COMPARED, "--format=markdown"), printed=True),
    "latex": Written("-table.tex", (*_COMPARED, "--format=latex"), printed=True),
}
ENDINGS = (*{f".{kind.ending.rpartition('.')[2]}": None for kind in WRITTEN.values()}, ".py")


async def written_by(words: list[str], printed: bool, path: Path) -> list[str]:
    """Have a command write a file, or keep what it prints as one; return what it warned of.

    Raises:
        CranktopoError: it failed, took too long, or the file cannot be written.
    """
    process = await asyncio.create_subprocess_exec(
        *own_command(*words), stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.PIPE
    )
    try:
        text, said = await asyncio.wait_for(process.communicate(), _LONGEST_S)
    except TimeoutError:
        process.kill()
        raise CranktopoError(f"{path.name}: took longer than {_LONGEST_S / 60:.0f} min.") from None
    lines = unfolded(said.decode("utf-8", "replace").strip())
    if process.returncode not in PARTLY:
        raise CranktopoError(f"{path.name}: {(lines or ['failed'])[-1].removeprefix('error: ')}")
    try:
        if printed:
            write_bytes(path, text)
    except OSError as error:
        raise CranktopoError(f"{path.name}: cannot be written: {error.strerror}.") from None
    return [line.removeprefix("warning: ") for line in lines if line.startswith("warning: ")]
