"""Features of a web: one file per kind says its keys, rules, bodies, drawing and how the re-model fits it.

An outline is registered here, any other feature in `web.py`.
"""

from typing import Annotated

from pydantic import Field

from cranktopo.scene.features.bevel import EndBevel
from cranktopo.scene.features.body import Body, Feature
from cranktopo.scene.features.box_pocket import BoxPocket
from cranktopo.scene.features.counterweight import Counterweight
from cranktopo.scene.features.cylinder_pocket import CylinderPocket
from cranktopo.scene.features.ellipse import EllipseWeb
from cranktopo.scene.features.hull import ObroundWeb, TaperedWeb
from cranktopo.scene.features.profile import ProfileWeb
from cranktopo.scene.features.rectangle import RectangleWeb
from cranktopo.scene.features.side_pocket import SidePocket
from cranktopo.scene.features.web import Pocket, WebTable, kept_bodies, web_bodies, web_spans

Web = Annotated[
    ObroundWeb | RectangleWeb | EllipseWeb | TaperedWeb | ProfileWeb, Field(discriminator="outline")
]

__all__ = [
    "Body",
    "BoxPocket",
    "Counterweight",
    "CylinderPocket",
    "EllipseWeb",
    "EndBevel",
    "Feature",
    "ObroundWeb",
    "Pocket",
    "ProfileWeb",
    "RectangleWeb",
    "SidePocket",
    "TaperedWeb",
    "Web",
    "WebTable",
    "kept_bodies",
    "web_bodies",
    "web_spans",
]
