"""The two halves of a throw, each as the throw of two equal webs that it is half of.

What a half throw is, has and weighs follows from such a scene; the second half is the mirror image of what
its scene describes. Where both are alike, both are the scene itself.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache
from typing import Any, TypeVar

from cranktopo.base.errors import CranktopoError
from cranktopo.design.schema import Scene

T = TypeVar("T")
_LENGTHS = {
    "second_main_journal_length_mm": "main_journal",
    "second_crankpin_length_mm": "crankpin",
}
"""Keys of the throw that give a journal another length beyond the crankpin."""


def difference(scene: Scene) -> str:
    """Key of the first thing that makes the halves differ; empty where they are alike."""
    throw = scene.throw
    if scene.second_web is not None and scene.second_web != scene.web:
        return "second_web"
    for key, name in _LENGTHS.items():
        if getattr(throw, key) not in (None, getattr(throw, name).length_mm):
            return f"throw.{key}"
    lonely = (index for index, drilling in enumerate(throw.drilling) if drilling.web != "both")
    return next((f"throw.drilling[{index}].web" for index in lonely), "")


@lru_cache(maxsize=16)
def halves(scene: Scene) -> tuple[Scene, Scene]:
    """Return the half throw from z = 0 to the mid-pin plane, and the one beyond, in its own frame."""
    if not difference(scene):
        return scene, scene
    return _half(scene, "first"), _half(scene, "second")


def of_halves(scene: Scene, found: Callable[[Scene], T]) -> tuple[T, T]:
    """Return what is found of each half, computed once where they are alike."""
    first, second = halves(scene)
    result = found(first)
    return result, result if second is first else found(second)


def drilled_alike(half: Scene) -> Scene:
    """A half without the drillings that it alone has, which may reach into the other; itself where it can."""
    both = tuple(drilling for drilling in half.throw.drilling if drilling.web == "both")
    if both == half.throw.drilling:
        return half
    return half.model_copy(update={"throw": half.throw.model_copy(update={"drilling": both})})


def require_equal_halves(scene: Scene) -> None:
    """Refuse a throw whose halves differ, for what models half of it.

    Raises:
        CranktopoError: they do.
    """
    key = difference(scene)
    if key:
        raise CranktopoError(
            f"{key}: the halves of the throw differ, and this command or stage models half of it.",
            hint="Taken by evaluate, compare, accuracy, fatigue, loads, plan, balance, shaft, vibration, "
            "export (not of half), sweep to evaluate or fatigue, and with --web by optimise, bound, shape, "
            "iterate and evaluate --sensitivities.",
        )


def of_second(error: CranktopoError, scene: Scene) -> CranktopoError:
    """Return what is wrong with the second half, by the keys of the scene that it comes from."""
    own = [str(i) for i, drilling in enumerate(scene.throw.drilling) if drilling.web != "first"]

    def named(text: str) -> str:
        if scene.second_web is not None:
            text = re.sub(r"(?<![\w.])web(?=\.[a-z])", "second_web", text)
        return re.sub(r"(?<=throw\.drilling\[)\d+", lambda found: own[int(found[0])], text)

    message = f"{named(error.message).removesuffix('.')} (in the half beyond the crankpin)."
    return CranktopoError(message, hint=named(error.hint), code=error.code)


def _half(scene: Scene, side: str) -> Scene:
    throw = scene.throw
    update: dict[str, Any] = dict.fromkeys(_LENGTHS)
    update["drilling"] = tuple(drilling for drilling in throw.drilling if drilling.web in ("both", side))
    second = side == "second"
    for key, name in _LENGTHS.items() if second else ():
        journal, length = getattr(throw, name), getattr(throw, key)
        update[name] = journal if length is None else journal.model_copy(update={"length_mm": length})
    web = scene.second_web if second and scene.second_web is not None else scene.web
    return scene.model_copy(update={"throw": throw.model_copy(update=update), "web": web, "second_web": None})
