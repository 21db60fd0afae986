"""Design, history and variants of a bench, all of it in files: a crash loses at most the drag in hand.

A folder `bench/NAME` beside the design: every step as a design, kept variants, and `state.json`, which is
replaced whole.
"""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from difflib import unified_diff
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

from pydantic import Field
from pydantic_core import PydanticCustomError

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import is_inside, read_text_file, write_json, write_text
from cranktopo.base.result import Result
from cranktopo.design.edits import changed_text, difference_words, differing_values
from cranktopo.design.goal.limit import read_limits
from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.design.scene_files import with_resolved_files
from cranktopo.design.toml_text import parse_toml
from cranktopo.design.writing import design_name
from cranktopo.runs.destination import locked
from cranktopo.tasks.bench.design_files import changed_files, check_files_inside

_BEGINNINGS = ("cranktopo designs new ", "cranktopo import ")
"""Commands that make the design that a session began with."""
_FOLDER, _STATE = "bench", "state.json"
_MOST_VALUES = 8
"""Of two variants, to be taken one by one."""
_HELD = "Go on at the page of that bench, or end it first."


class DesignStep(Result):
    """One state of the design: its file, what was done to get there, and the command that does the same."""

    file: str
    what: str
    command: str


class Variant(Result):
    """A design that was kept, with its gauges as far as they were known."""

    id: str
    name: str
    file: str
    what: str = ""
    gauges: dict[str, float] = Field(default_factory=dict)
    pinned: bool = False
    outlines: tuple[tuple[tuple[float, float], ...], ...] = ()


class MadeFile(Result):
    """A file that was written, and the command that writes it."""

    name: str
    command: str


class _State(Result):
    schema_version: int = 1
    name: str
    source: str
    at: int = 0
    original: int = 0
    steps: tuple[DesignStep, ...] = ()
    variants: tuple[Variant, ...] = ()
    made: tuple[MadeFile, ...] = ()


class Project:
    """One design on the bench, with its history and variants.

    Attributes:
        folder: folder that the user chose; nothing outside it is read or written.
        place: where the session is kept; no other bench has it until `close`.
    """

    def __init__(self, folder: Path, place: Path) -> None:
        """Take hold of a session and read it; raises CranktopoError where another bench has it."""
        self.folder, self.place = folder, place
        with ExitStack() as held:
            held.enter_context(locked(place, "session", _HELD))
            self._state = _State.read(place / _STATE)
            self._text = self.text_of(self._state.at)
            self._held = held.pop_all()

    @classmethod
    def opened(
        cls, folder: Path, text: str, source: str, what: str, command: str, at_hand: Project | None = None
    ) -> Project:
        """Return the session of a design; one that was left goes on, if it began with the same text.

        Args:
            text: of the design, file names relative to the folder or absolute.
            source: file name of the design, for messages and for the name.
            at_hand: session that is open here, which is returned if it is that of the design.

        Raises:
            CranktopoError: another bench has the session.
        """
        name = design_name(Path(source).with_suffix(".toml"))
        root = folder / _FOLDER
        for number in range(1, 1000):
            place = root / (name if number == 1 else f"{name}-{number}")
            if not (place / _STATE).is_file() or _first_text(place) == text:
                break
        if at_hand is not None and at_hand.place == place:
            return at_hand
        first = DesignStep(file="0000.toml", what=what, command=command)
        if not (place / _STATE).is_file():
            place.mkdir(parents=True, exist_ok=True)
            write_text(place / first.file, text)
            write_json(place / _STATE, _State(name=name, source=source, steps=(first,)).as_json())
        return cls(folder, place)

    def close(self) -> None:
        """Leave the session to other benches."""
        self._held.close()

    @property
    def name(self) -> str:
        """Name of the session."""
        return self._state.name

    @property
    def step(self) -> DesignStep:
        """The step that is shown."""
        return self._state.steps[self._state.at]

    @property
    def at(self) -> int:
        """Number of the step that is shown."""
        return self._state.at

    @property
    def text(self) -> str:
        """The design as it stands."""
        return self._text

    @property
    def variants(self) -> tuple[Variant, ...]:
        """The kept variants."""
        return self._state.variants

    def text_of(self, number: int) -> str:
        """Return the text of a step."""
        return read_text_file(self.place / self._state.steps[number].file, "design")

    def data(self, text: str | None = None) -> dict[str, Any]:
        """Return the tables of the design, or of another text, file names absolute; not to be changed."""
        return _tables(self._text if text is None else text, self.folder)

    @cached_property
    def opened_data(self) -> dict[str, Any]:
        """Tables of the design as it was opened, whose files are trusted."""
        return self.data(self.text_of(0))

    def runnable(self, number: int) -> str:
        """Return a file with a step for commands in the folder: its own, or a copy that finds its files.

        The names of files in a step are relative to the folder, and the step lies deeper in it.
        """
        file, text = self.place / self._state.steps[number].file, self.text_of(number)
        moved = changed_files(text, self.folder)
        if moved != text:
            file = self.place / "written" / file.name
            file.parent.mkdir(exist_ok=True)
            write_text(file, moved)
        return file.relative_to(self.folder).as_posix()

    def commands(self) -> list[str]:
        """Return commands that make a file of the design as it stands, with everything that was entered."""
        first = self._state.steps[0].command
        begun = [first] if first.startswith(_BEGINNINGS) else []
        return (
            begun
            if begun and self._state.at == 0
            else [*begun, self._copy_line(self.runnable(self._state.at))]
        )

    def _copy_line(self, file: str) -> str:
        source = file if "/" in file else (self.place / file).relative_to(self.folder).as_posix()
        return shlex.join(["cranktopo", "designs", "copy", source, f"{self.name}-{Path(file).stem}.toml"])

    def as_steps(self, first: int, last: int) -> tuple[DesignStep, ...]:
        """Return the steps after one up to another."""
        return self._state.steps[first + 1 : last + 1]

    @property
    def original(self) -> int:
        """Number of the step that gauges are compared with."""
        return self._state.original

    def pin(self) -> None:
        """Compare with the design as it stands from now on."""
        self._write(original=self._state.at)

    def change(self, changes: Mapping[str, Any], what: str) -> None:
        """Take a step: the design with values at key paths."""
        self.replace(changed_text(self._text, changes, "design"), what)

    def replace(self, text: str, what: str) -> None:
        """Take a step to another text; what was undone before is given up."""
        check_files_inside(self.data(text), self.folder, self.opened_data)
        if text == self._text:
            return
        kept = self._state.steps[: self._state.at + 1]
        number = 1 + max(int(Path(step.file).stem) for step in self._state.steps)
        step = DesignStep(file=f"{number:04d}.toml", what=what, command=self._copy_line(f"{number:04d}.toml"))
        write_text(self.place / step.file, text)
        self._write(steps=(*kept, step), at=len(kept), original=min(self._state.original, len(kept) - 1))
        self._text = text

    def move(self, by: int) -> None:
        """Undo (-1), redo (+1), or go further; nothing beyond the ends of the history."""
        at = self._state.at + by
        if 0 <= at < len(self._state.steps):
            self._write(at=at)
            self._text = self.text_of(at)

    def keep(
        self,
        name: str,
        gauges: Mapping[str, float],
        text: str | None = None,
        what: str = "",
        outlines: Sequence[Any] = (),
    ) -> Variant:
        """Keep a variant: the design as it stands, or another text; its name and its words are its own.

        Args:
            outlines: of its web, for a small picture.
        """
        number = 1 + max((int(variant.id[1:]) for variant in self.variants), default=0)
        id_, kept = f"v{number}", self._text if text is None else text
        clean = " ".join(name.split())[:60] or f"variant {number}"
        clean += f" ({number})" if any(variant.name == clean for variant in self.variants) else ""
        what = self._words_of_its_own(what, kept)
        contents: dict[str, Any] = {"what": what, "gauges": dict(gauges), "outlines": outlines}
        variant = Variant(id=id_, name=clean, file=f"{id_}.toml", **contents)
        write_text(self.place / variant.file, kept)
        self._write(variants=(*self.variants, variant))
        return variant

    def _words_of_its_own(self, what: str, text: str) -> str:
        """Return what a variant is, and how it differs from an earlier one of which the same is said."""
        for other in reversed(self.variants):
            if other.what == what:
                differs = difference_words(self.data(self.variant_text(other.id)), self.data(text))
                return f"{what}; {f'beside {other.name}: {differs}' if differs else f'as {other.name}'}"
        return what

    def update_variant(self, id_: str, **changes: Any) -> None:
        """Change a variant's gauges or pin."""
        self._write(variants=tuple(v.model_copy(update=changes) if v.id == id_ else v for v in self.variants))

    def drop(self, id_: str) -> None:
        """Give up a variant; its file stays."""
        self._write(variants=tuple(variant for variant in self.variants if variant.id != id_))

    @property
    def files(self) -> tuple[MadeFile, ...]:
        """Files that were written, each once, the newest last."""
        return self._state.made

    def record_file(self, name: str, command: str) -> None:
        """Record a file that was written."""
        others = (file for file in self.files if file.name != name)
        self._write(made=(*others, MadeFile(name=name, command=command)))

    def _compared(self) -> dict[str, Any]:
        """Return how the second of the variants that are compared differs from the first; empty for fewer."""
        pinned = [variant for variant in self.variants if variant.pinned][:2]
        if len(pinned) < 2:
            return {"words": "", "values": {}}
        first, second = (self.data(self.variant_text(variant.id)) for variant in pinned)
        differs = difference_words(first, second) or "the same"
        values = dict(list(differing_values(first, second).items())[:_MOST_VALUES])
        return {"words": f"{pinned[1].name} beside {pinned[0].name}: {differs}", "values": values}

    def variant_text(self, id_: str) -> str:
        """Return the design of a variant."""
        for variant in self.variants:
            if variant.id == id_:
                return read_text_file(self.place / variant.file, f"variant '{variant.name}'")
        raise CranktopoError(f"variant '{id_}': there is none.")

    def as_json(self) -> dict[str, Any]:
        """Return what the page shows of the session."""
        return {
            "name": self.name,
            "folder": str(self.folder),
            "at": self._state.at,
            "original": self._state.original,
            "steps": [step.as_json() for step in self._state.steps],
            "variants": [variant.as_json() for variant in self.variants],
            "compared": self._compared(),
            "made": [file.as_json() for file in self.files],
            "data": self.data(),
            "limits": gauge_limits(self.data()),
            "commands": self.commands(),
            "diff": list(
                unified_diff(self.text_of(0).splitlines(), self._text.splitlines(), n=1, lineterm="")
            )[2:],
        }

    def _write(self, **changes: Any) -> None:
        state = self._state.model_copy(update=changes)
        write_json(self.place / _STATE, state.as_json())
        self._state = state


def _first_text(place: Path) -> str:
    """Return the design that a session began with."""
    first = _State.read(place / _STATE).steps[0]
    return read_text_file(place / first.file, "design")


@lru_cache(maxsize=4)
def _tables(text: str, folder: Path) -> dict[str, Any]:
    """Tables of a text: every move of a drag asks for those of the same one."""
    return with_resolved_files(parse_toml(text, "design"), folder)


def file_in(folder: Path, name: str, suffixes: tuple[str, ...]) -> Path:
    """Return the path of a file that the page may write or send: by its plain name, in the folder."""
    path = folder / name
    if not is_inside(name) or Path(name).name != name or name.startswith(".") or path.is_symlink():
        raise CranktopoError(f"file '{name[:80]}': must be a plain name in the folder of the bench.")
    if path.suffix.lower() not in suffixes:
        raise CranktopoError(f"file '{name[:80]}': must end with {', '.join(suffixes)}.")
    return path


def gauge_limits(data: Mapping[str, Any]) -> dict[str, list[dict[str, Any]]]:
    """Return the limits of `[goal.limits]` by quantity, two for a range; none that cannot be read.

    Each has its text as it is written, `sense`, and `value` in the internal unit of the quantity, or in
    percent of the original where `percent` is true.
    """
    table = (data.get("goal") or {}).get("limits") or {}
    found = {name: _readable_limits(name, table[name]) for name in QUANTITIES if name in table}
    return {name: limits for name, limits in found.items() if limits}


def _readable_limits(name: Any, value: Any) -> list[dict[str, Any]]:
    texts = value if isinstance(value, list | tuple) else [value]
    try:
        limits = read_limits(QUANTITIES[name], value)
    except PydanticCustomError:
        return []  # the form says what is wrong with it
    return [
        {"text": text.strip(), "sense": limit.sense, "value": limit.value, "percent": limit.percent}
        for text, limit in zip(texts, limits, strict=False)
    ]
