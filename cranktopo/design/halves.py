"""The two halves of a throw, each as the throw of two equal webs that it is half of; symmetry, usual sizes.

What a half throw is, has and weighs follows from such a scene; the second half is the mirror image of what
its scene describes. Where both are alike, both are the scene itself.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache
from typing import Any, Literal, TypeVar

from cranktopo.base.errors import CranktopoError
from cranktopo.design.schema import Scene
from cranktopo.throw.drilling.table import drilling_asymmetry
from cranktopo.throw.zone import zones_asymmetry

T = TypeVar("T")
WebName = Literal["first", "second"]
"""Halves of a throw by their webs, from the free end."""
_LENGTHS = {"second_main_journal_length_mm": "main_journal", "second_crankpin_length_mm": "crankpin"}
"""Keys of the throw that give a journal another length beyond the crankpin."""


def difference(scene: Scene) -> str:
    """Key of the first thing that makes the halves differ; empty where they are alike."""
    throw = scene.throw
    if scene.second_web is not None and scene.second_web != scene.web:
        return "second_web"
    if throw.second_main_journal not in (None, throw.main_journal):
        return "throw.second_main_journal"
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


def of_halves(scene: Scene, function: Callable[[Scene], T]) -> tuple[T, T]:
    """Return what is found of each half, computed once where they are alike."""
    first, second = halves(scene)
    result = function(first)
    return result, result if second is first else function(second)


def judged_half(half: Scene) -> Scene:
    """The throw that has a half twice, drilled where the half alone is: in its first half."""
    own = tuple(
        drilling if drilling.web == "both" else drilling.model_copy(update={"web": "first"})
        for drilling in half.throw.drilling
    )
    return half.with_drillings(own)


def require_equal_halves(scene: Scene) -> None:
    """Refuse a throw whose halves differ, for what models half of it."""
    key = difference(scene)
    if key:
        raise CranktopoError(
            f"{key}: the halves of the throw differ, and this command or stage models half of it.",
            hint="Taken by evaluate, compare, accuracy, fatigue, loads, plan, balance, shaft, vibration, "
            "modes, export (not of half), sweep to evaluate or fatigue, and with --web by optimise, bound, "
            "shape, iterate and evaluate --sensitivities.",
        )


def of_second(error: CranktopoError, scene: Scene) -> CranktopoError:
    """Return what is wrong with the second half, by the keys of the scene that it comes from."""
    named = named_in_throw(error.message, scene, "second")
    message = f"{named.removesuffix('.')} (in the half beyond the crankpin)."
    return CranktopoError(message, hint=named_in_throw(error.hint, scene, "second"), code=error.code)


def named_in_throw(text: str, scene: Scene, side: WebName) -> str:
    """Return a text about a half with the keys of the scene that the half comes from."""
    own = [str(i) for i, drilling in enumerate(scene.throw.drilling) if drilling.web in ("both", side)]
    if side == "second" and scene.second_web is not None:
        text = re.sub(r"(?<![\w.])web(?=\.[a-z])", "second_web", text)
    if side == "second" and scene.throw.second_main_journal is not None:
        text = text.replace("throw.main_journal", "throw.second_main_journal")
    return re.sub(r"(?<=throw\.drilling\[)\d+", lambda found: own[int(found[0])], text)


def _half(scene: Scene, side: WebName) -> Scene:
    throw = scene.throw
    update: dict[str, Any] = dict.fromkeys((*_LENGTHS, "second_main_journal"))
    update["drilling"] = tuple(drilling for drilling in throw.drilling if drilling.web in ("both", side))
    second = side == "second"
    for key, name in _LENGTHS.items() if second else ():
        journal, length = getattr(throw, name), getattr(throw, key)
        if name == "main_journal":
            journal = throw.second_main_journal or journal
        update[name] = journal if length is None else journal.model_copy(update={"length_mm": length})
    web = scene.second_web if second and scene.second_web is not None else scene.web
    return scene.model_copy(update={"throw": throw.model_copy(update=update), "web": web, "second_web": None})


def web_asymmetry(scene: Scene) -> str:
    """Key of the first feature of a web, or drilling, without a mirrored twin; empty where all have one."""
    first, second = halves(scene)
    other = "" if second is first else _asymmetry(second)
    return _asymmetry(first) or (other and f"the second half's {other}")


def _asymmetry(scene: Scene) -> str:
    features = list(scene.web.features())
    twins = [feature for _, feature in features]
    lonely = (key for key, feature in features if feature.mirrored() not in twins)
    return next(lonely, drilling_asymmetry(scene))


def envelope_asymmetry(scene: Scene) -> str:
    """Key of an envelope, drilling or kept feature not symmetric in x, or not known to be; empty for none."""
    own = scene.envelope.asymmetry if scene.envelope else ""
    return own or drilling_asymmetry(scene) or kept_asymmetry(scene) or _zones_asymmetry(scene)


def _zones_asymmetry(scene: Scene) -> str:
    """Key of a zone without its mirror image, or of what of a web that has zones has none."""
    if scene.envelope is None or not keeps_parts(scene):
        return ""
    return zones_asymmetry(scene.envelope.frozen, scene.envelope.removable) or web_asymmetry(scene)


def has_zones(scene: Scene) -> bool:
    """Tell whether zones of the envelope keep part of the web as it is."""
    return scene.envelope is not None and bool(scene.envelope.frozen or scene.envelope.removable)


def keeps_parts(scene: Scene) -> bool:
    """Tell whether part of the web stays as it is: in zones, or below a bolted counterweight."""
    weight = scene.web.counterweight
    return has_zones(scene) or bool(scene.envelope and weight and weight.bolted)


def without_zones(scene: Scene) -> Scene:
    """Return the scene with all of its envelope free."""
    if not has_zones(scene):
        return scene
    assert scene.envelope is not None
    free = scene.envelope.model_copy(update={"frozen": (), "removable": ()})
    return scene.model_copy(update={"envelope": free})


def kept_asymmetry(scene: Scene) -> str:
    """Key of the first feature without a mirrored twin whose bodies no optimiser changes; empty for none."""
    kept = ((key, one) for key, one in scene.web.features() if one.occupied(scene, key))
    return next((key for key, feature in kept if feature.mirrored() != feature), "")


def mirror_image(scene: Scene) -> Scene:
    """Return the scene with its web and drillings mirrored in x = 0."""
    turned: dict[str, Any] = {
        key: tuple(feature.mirrored() for feature in getattr(scene.web, key))
        for key in scene.web.feature_keys
    }
    singles = {key: getattr(scene.web, key) for key in scene.web.single_keys}
    turned |= {key: feature and feature.mirrored() for key, feature in singles.items()}
    drilled = {"drilling": tuple(drilling.mirrored() for drilling in scene.throw.drilling)}
    throw, web = scene.throw.model_copy(update=drilled), scene.web.model_copy(update=turned)
    return scene.model_copy(update={"throw": throw, "web": web})


def may_mirror(scene: Scene, asymmetry: str) -> bool:
    """Tell whether x = 0 may serve as a mirror: no asymmetry was found and the scene does not forbid it."""
    return not asymmetry and scene.effects.lateral_symmetry != "off"


_USUAL_MM = (42.0, 84.0)
"""Diameters of the thinner journal between which nothing is scaled."""


def usual_scale(scene: Scene) -> float:
    """Factor that brings the thinner journal to the nearest usual diameter; 1 within their range."""
    return scale_to_usual(min(journal.outer_diameter_mm for journal, _ in scene.throw.journals))


def scale_to_usual(thinner_mm: float) -> float:
    """Return the same factor by the diameter of the thinner journal."""
    low, high = _USUAL_MM
    return min(max(thinner_mm, low), high) / thinner_mm


def default_element_size_mm(scene: Scene) -> float:
    """General element size by default: a tenth of the thinner journal, at most a third of a web, mm."""
    throw = scene.throw
    journal = min(throw.main_journal.outer_diameter_mm, throw.crankpin.outer_diameter_mm)
    return min(journal / 10, *(half.web.thickness_mm / 3 for half in halves(scene)))
