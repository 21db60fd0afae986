"""Studies kept in the user's cache, so that an accuracy or a budget can choose a level without measuring."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import read_json, write_json
from cranktopo.base.machine import this_machine, user_cache
from cranktopo.tasks.fea.level import StudyName
from cranktopo.tasks.fea.study_result import LevelResult, StudyResult
from cranktopo.tasks.fea.targets import Target

SCHEMA_VERSION = 2


@dataclass(frozen=True)
class StoredStudy:
    """What `accuracy --json` printed of a design; `slowdown`: how much slower the machine is now."""

    design: str
    slowdown: float
    result: StudyResult

    def levels(self, study: StudyName) -> list[LevelResult]:
        """Return the levels of a study."""
        return [level for level in self.result.rungs if level.ladder == study]


def studies_path() -> Path:
    """Return the file of studies in the user's cache."""
    return user_cache() / "accuracy.json"


def key_of(target: Target) -> str:
    """What a target's study is kept under: a design's name, or the path of the surface of a run or file.

    A surface has no name of its own: every run directory `web` would pass for the design `web`.
    """
    return target.name if target.file is None else str(target.file.resolve())


def store_study(key: str, result: StudyResult) -> Path | None:
    """Keep what `accuracy --json` prints; None where nothing was measured or the cache cannot be written."""
    if not result.rungs:
        return None
    stored = {name: kept for name, kept in _stored().items() if name != key}  # the newest is the last
    try:
        studies_path().parent.mkdir(parents=True, exist_ok=True)
        designs = {name: kept.as_json() for name, kept in {**stored, key: result}.items()}
        write_json(studies_path(), {"schema_version": SCHEMA_VERSION, "designs": designs})
    except (OSError, CranktopoError):
        return None
    return studies_path()


def load_study(key: str, study: StudyName) -> StoredStudy | None:
    """Return what was measured under a key, or else the newest other design, that holds a study.

    None where nothing was measured on a machine of this kind. Surfaces have only the evaluation's study.
    """
    stored = _stored()
    if not stored:
        return None
    here, usable = this_machine(), {}  # timed only when there is something to compare
    for name, result in stored.items():
        machine = result.machine
        if machine.same_kind(here) and any(level.ladder == study for level in result.rungs):
            usable[name] = StoredStudy(name, here.reference_s / machine.reference_s, result)
    return usable.get(key) or (list(usable.values())[-1] if usable else None)


def _stored() -> dict[str, StudyResult]:
    """Studies by key; none where there is no file, one of another version, or a damaged one."""
    try:
        data = read_json(studies_path())
        valid = data["schema_version"] == SCHEMA_VERSION
        designs = data["designs"] if valid else {}
        return {name: StudyResult.of_json(kept, name) for name, kept in designs.items()}
    except (OSError, CranktopoError, KeyError, TypeError, AttributeError):
        return {}
