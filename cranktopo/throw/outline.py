"""Features of a web: one file per kind says its keys, rules, bodies, drawing and how the re-model fits it.

An outline is registered here, any other feature in `web.py`.
"""

from typing import Annotated

from pydantic import Field

from cranktopo.throw.ellipse import EllipseWeb
from cranktopo.throw.hull import ObroundWeb, TaperedWeb
from cranktopo.throw.profile import ProfileWeb
from cranktopo.throw.rectangle import RectangleWeb

Web = Annotated[
    ObroundWeb | RectangleWeb | EllipseWeb | TaperedWeb | ProfileWeb, Field(discriminator="outline")
]
