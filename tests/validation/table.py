"""A table of printed and own results, as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """A printed result beside ours."""

    what: str
    printed: float
    ours: float
    unit: str

    @property
    def off(self) -> float:
        """Difference over the printed value."""
        return self.ours / self.printed - 1

    def cells(self) -> list[str]:
        printed, ours = (
            f"{value:,.0f}" if value >= 1e4 else f"{value:.5g}" for value in (self.printed, self.ours)
        )
        return [self.what, f"{printed} {self.unit}", f"{ours} {self.unit}", f"{100 * self.off:+.2g} %"]


def table(rows: Iterable[Row]) -> str:
    return lines_of(("quantity", "printed", "cranktopo", "difference"), [row.cells() for row in rows])


def input_table(inputs: Iterable[tuple[str, str]]) -> str:
    return lines_of(("input", "value"), inputs)


def lines_of(head: Sequence[str], cells: Iterable[Sequence[str]]) -> str:
    rule = ["---", *["--:"] * (len(head) - 1)]
    return "\n".join("| " + " | ".join(line) + " |" for line in (head, rule, *cells))
