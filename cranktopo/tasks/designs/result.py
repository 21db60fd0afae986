"""JSON of `designs list`."""

from __future__ import annotations

from cranktopo.base.result import Result


class ListedDesign(Result):
    """A built-in design."""

    name: str
    """As any command takes it."""
    description: str


class DesignList(Result):
    """The built-in designs."""

    schema_version: int = 1
    designs: tuple[ListedDesign, ...]
