"""Consistency of the whole crank: throws, main journals, ends; each of its throws is checked as a scene."""

from __future__ import annotations

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.design.checks.scene import check_proportion, check_scene
from cranktopo.design.crank import Crank
from cranktopo.design.crank_throws import carried, end_journal, throw_count, throw_scenes
from cranktopo.design.schema import Scene
from cranktopo.throw.crank_end import BodyStep, CrankEnd
from cranktopo.throw.end_holes import closed_hole


def check_crank(scene: Scene) -> None:
    """Check that the crank's throws, main journals and ends are there once and give sound bodies."""
    crank = scene.crank
    if crank is None:
        return
    _check_counts(scene, crank)
    _check_pitch(scene, crank)
    _check_bearings(scene, crank)
    for place, end in enumerate(crank.end):
        if any(other.side == end.side for other in crank.end[:place]):
            raise scene.invalid(f"crank.end[{place}].side", "that end is given twice", "Join their steps.")
        _check_steps(scene, f"crank.end[{place}]", end)
        _check_holes(scene, f"crank.end[{place}]", end)
    if not crank.uniform:
        _check_throws(scene)


def _check_counts(scene: Scene, crank: Crank) -> None:
    count = throw_count(scene)
    if crank.throws and len(crank.throws) != count:
        raise scene.invalid(
            "crank.throws",
            f"names {len(crank.throws)} throws; the engine has {count}",
            "Name one for each throw, from the free end, or leave it out.",
        )
    for place, journal in enumerate(crank.main_journal):
        key = f"crank.main_journal[{place}].number"
        if journal.number > count:
            raise scene.invalid(key, f"must be >= 0 and <= {count}: the crank has {count} throws")
        if any(other.number == journal.number for other in crank.main_journal[:place]):
            raise scene.invalid(key, "is there twice", "Keep one of them.")


def _check_bearings(scene: Scene, crank: Crank) -> None:
    count, bearings = throw_count(scene), crank.bearings
    if bearings and (
        sorted(set(bearings)) != list(bearings) or bearings[0] != 0 or bearings[-1] != count or count == 0
    ):
        raise scene.invalid(
            "crank.bearings",
            f"must be numbers of main journals, rising from 0 to {count}",
            "The outer ones sit in bearings.",
        )
    for place, journal in enumerate(crank.main_journal):
        if journal.length_mm == 0 and journal.number in carried(scene):
            raise scene.invalid(
                f"crank.main_journal[{place}].length_mm",
                "a journal in a bearing has a length",
                f"For a flying web leave {journal.number} out of crank.bearings.",
            )


def _check_pitch(scene: Scene, crank: Crank) -> None:
    """The lengths of different throws are their pitch."""
    pitch = scene.engine.arranged.cylinder_pitch_mm if scene.engine else None
    if pitch is not None and not crank.uniform:
        raise invalid(
            "engine.arrangement.cylinder_pitch_mm",
            pitch,
            "the lengths of the throws of [crank] are the distances of the cylinders",
            "Leave it out.",
        )


def _check_steps(scene: Scene, key: str, end: CrankEnd) -> None:
    for place, step in enumerate(end.step):
        path = f"{key}.step[{place}]"
        step.check(path)
        for name, value in step.model_dump(exclude={"run_out_mm"}).items():
            if name.endswith("_mm"):
                check_proportion(scene, f"{path}.{name}", value)
        if isinstance(step, BodyStep) and place < len(end.step) - 1:
            raise invalid(f"{path}.kind", "body", "must be the last step of its end", "Move it there.")


def _check_holes(scene: Scene, key: str, end: CrankEnd) -> None:
    journal = end_journal(scene, end.side)
    hole = closed_hole(journal, end.step) if journal else None
    if hole is not None:
        raise invalid(
            f"{key}.step[{hole.step}].{hole.key}",
            2 * hole.radius_mm,
            "is a closed hollow that no tool reaches: the steps beside it cover it",
            "Bore the steps up to it from outside, or leave it out.",
        )


def _check_throws(scene: Scene) -> None:
    throws = throw_scenes(scene)
    for number, throw in enumerate(throws, start=1):
        if any(throw is before for before in throws[: number - 1]):
            continue
        try:
            check_scene(throw)
        except CranktopoError as error:
            message = f"throw {number} of the crank: {error.message}"
            raise CranktopoError(message, hint=error.hint, code=error.code) from None
