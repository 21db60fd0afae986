"""JSON of `doctor`."""

from __future__ import annotations

from cranktopo.base.result import Result
from cranktopo.tasks.doctor.stage import Check


class MachineChecks(Result):
    """Everything looked at on this machine."""

    schema_version: int = 1
    ready: bool
    """True where nothing needed is missing or short of memory."""
    checks: tuple[Check, ...]
