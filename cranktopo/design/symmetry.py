"""Is a throw its own mirror image in x = 0? Then half of it is enough."""

from __future__ import annotations

from typing import Any

from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.throw.drilling.table import drilling_asymmetry


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
    """Key of an envelope or drilling that is not symmetric in x, or not known to be; empty for none."""
    return (scene.envelope.asymmetry if scene.envelope else "") or drilling_asymmetry(scene)


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
    """Tell whether x = 0 may serve as a mirror: nothing is asymmetric and the scene does not forbid it.

    Args:
        asymmetry: what `web_asymmetry` or `envelope_asymmetry` found; empty for nothing.
    """
    return not asymmetry and scene.effects.lateral_symmetry != "off"
