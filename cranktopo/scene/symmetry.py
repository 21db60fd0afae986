"""Is a throw its own mirror image in x = 0? Then half of it is enough."""

from __future__ import annotations

from cranktopo.scene.geometry import Pocket
from cranktopo.scene.schema import Scene


def web_asymmetry(scene: Scene) -> str:
    """Key of the first pocket of the web without its mirrored twin; empty when the web is symmetric in x."""
    pockets = scene.web.pocket
    lonely = (index for index, pocket in enumerate(pockets) if _mirrored(pocket) not in pockets)
    return next((f"web.pocket.{index}" for index in lonely), "")


def envelope_asymmetry(scene: Scene) -> str:
    """Key of an envelope that is not symmetric in x, or not known to be; empty when it is or is absent."""
    envelope = scene.envelope
    if envelope is not None and envelope.shape == "stl":
        return "" if envelope.symmetric else "envelope (a file, not said to be symmetric)"
    if envelope is not None and envelope.shape == "outline":
        points = {(round(x, 9), round(y, 9)) for x, y in envelope.points_mm}
        if points != {(round(-x, 9) + 0.0, y) for x, y in points}:
            return "envelope.points_mm"
    return ""


def mirror_image(scene: Scene) -> Scene:
    """The scene with its web mirrored in x = 0."""
    turned = tuple(_mirrored(pocket) for pocket in scene.web.pocket)
    return scene.model_copy(update={"web": scene.web.model_copy(update={"pocket": turned})})


def may_mirror(scene: Scene, asymmetry: str) -> bool:
    """Whether x = 0 may serve as a mirror: nothing is asymmetric and the scene does not forbid it.

    Args:
        scene: says whether the mirror may be used.
        asymmetry: what `web_asymmetry` or `envelope_asymmetry` found; empty for nothing.
    """
    return not asymmetry and scene.effects.lateral_symmetry != "off"


def _mirrored(pocket: Pocket) -> Pocket:
    if pocket.shape == "side":
        return pocket
    return pocket.model_copy(update={"x_mm": -pocket.x_mm + 0.0})
