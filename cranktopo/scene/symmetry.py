"""Is a throw its own mirror image in x = 0? Then half of it is enough."""

from __future__ import annotations

from cranktopo.scene.schema import Scene


def web_asymmetry(scene: Scene) -> str:
    """Key of the web's first feature without its mirrored twin; empty when the web is symmetric in x."""
    features = list(scene.web.features())
    twins = [feature for _, feature in features]
    return next((key for key, feature in features if feature.mirrored() not in twins), "")


def envelope_asymmetry(scene: Scene) -> str:
    """Key of an envelope that is not symmetric in x, or not known to be; empty when it is or is absent."""
    return scene.envelope.asymmetry if scene.envelope else ""


def mirror_image(scene: Scene) -> Scene:
    """The scene with its web mirrored in x = 0."""
    turned = {
        key: tuple(feature.mirrored() for feature in getattr(scene.web, key))
        for key in scene.web.feature_keys
    }
    return scene.model_copy(update={"web": scene.web.model_copy(update=turned)})


def may_mirror(scene: Scene, asymmetry: str) -> bool:
    """Whether x = 0 may serve as a mirror: nothing is asymmetric and the scene does not forbid it.

    Args:
        asymmetry: what `web_asymmetry` or `envelope_asymmetry` found; empty for nothing.
    """
    return not asymmetry and scene.effects.lateral_symmetry != "off"
