"""A web that is sound only as it is written, to 0.01 mm, has its quantities as such."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import scene_from_dict
from cranktopo.tasks.refit.family import Layout
from cranktopo.tasks.refit.fit import usual_limits
from cranktopo.tasks.web_shape.mesh_model import MeshedWebs
from cranktopo.tasks.web_shape.stage import responses_of_sound_web
from cranktopo.throw.bevel import FittedBevel
from tests.hostile.featured_engines import featured_engine

OUTLINE = [-5.2573237, 9.9991247, 1.6927173, 4.1450607, 6.1925276, 5.6123592, 3.3329951]
STEEP = [9.6511170, 2.4266493, 0.0829232]
"""A bevel of 0.35 mm along the web and 2.43 mm depth, as a search of engine 34 found it."""


def test_a_steep_bevel_has_the_quantities_of_the_web_that_is_written() -> None:
    scene = scene_from_dict(featured_engine(34))
    layout, values = Layout(7, (FittedBevel("journal", True, 3.0),)), np.array([*OUTLINE, *STEEP])
    webs = MeshedWebs(scene, usual_limits(scene), 3.0)
    with pytest.raises(CranktopoError, match="through the web"):
        webs.responses(webs.web(layout), values)
    found = responses_of_sound_web(webs, layout, values)
    written = webs.responses(webs.web(layout), np.round(values, 2))
    assert found.values == written.values
