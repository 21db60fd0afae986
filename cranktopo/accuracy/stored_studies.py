"""Frontiers kept in the user's cache, so that an accuracy or a budget can choose a rung without measuring."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cranktopo.accuracy.level import StudyName
from cranktopo.accuracy.machine import Machine, this_machine
from cranktopo.errors import CranktopoError
from cranktopo.evaluate.targets import Target
from cranktopo.store import read_json, user_cache, write_json

SCHEMA_VERSION = 1
_FILE = "accuracy.json"


@dataclass(frozen=True)
class Known:
    """What was measured on this machine.

    Attributes:
        design: the design, or the path of the surface, that was measured.
        slowdown: how many times slower this machine is now.
        result: what `cranktopo accuracy --json` printed.
    """

    design: str
    slowdown: float
    result: dict[str, Any]

    def rungs(self, ladder: StudyName) -> list[dict[str, Any]]:
        """Rungs of a ladder."""
        return [rung for rung in self.result["rungs"] if rung["ladder"] == ladder]


def memory_path() -> Path:
    """The file of frontiers in the user's cache."""
    return user_cache() / _FILE


def key_of(target: Target) -> str:
    """What a target's frontier is kept under: a design's name, or the path of the surface of a run or file.

    A surface has no name of its own: every run directory `web` would pass for the design `web`.
    """
    return target.name if target.file is None else str(target.file.resolve())


def remember(key: str, result: Mapping[str, Any]) -> Path | None:
    """Keep a frontier; those of another machine or version are dropped.

    Args:
        key: from `key_of`.
        result: what `cranktopo accuracy --json` prints.

    Returns:
        The file, or None where the cache cannot be written or nothing was measured.
    """
    if not result["rungs"]:
        return None
    machine = Machine(**result["machine"])
    kept = _of_kind(_stored(), machine)
    kept.pop(key, None)  # the newest is the last
    data = {"schema_version": SCHEMA_VERSION, "designs": {**kept, key: dict(result)}}
    try:
        memory_path().parent.mkdir(parents=True, exist_ok=True)
        write_json(memory_path(), data)
    except (OSError, CranktopoError):
        return None
    return memory_path()


def recall(key: str, ladder: StudyName) -> Known | None:
    """A frontier on this machine that holds a ladder, or else the newest other one that does.

    Args:
        key: from `key_of`.
        ladder: what is wanted of it; surfaces have only the judge's.

    Returns:
        What was measured, or None where nothing was measured on a machine of this kind.
    """
    stored = _stored()
    if not stored:
        return None
    machine = this_machine()  # timed only when there is something to compare
    kept = {name: v for name, v in _of_kind(stored, machine).items() if _holds(v, ladder)}
    if not kept:
        return None
    name = key if key in kept else list(kept)[-1]
    before = Machine(**kept[name]["machine"])
    return Known(name, machine.reference_s / before.reference_s, kept[name])


def _holds(result: Mapping[str, Any], ladder: StudyName) -> bool:
    return any(rung["ladder"] == ladder for rung in result["rungs"])


def _stored() -> dict[str, Any]:
    """Frontiers by design; none where there is no file, or one of another version."""
    if not memory_path().is_file():
        return {}
    try:
        data = read_json(memory_path())
        return dict(data["designs"]) if data["schema_version"] == SCHEMA_VERSION else {}
    except (CranktopoError, KeyError, TypeError):
        return {}


def _of_kind(stored: Mapping[str, Any], machine: Machine) -> dict[str, Any]:
    """Those of machines of this kind; none where an entry cannot be read."""
    try:
        return {k: v for k, v in stored.items() if Machine(**v["machine"]).same_kind(machine)}
    except (KeyError, TypeError):
        return {}
