"""Lines of a rod by finite elements."""

import pytest

from cranktopo.tasks.rod.element_text import too_coarse
from cranktopo.tasks.rod.result import RodElements


@pytest.mark.parametrize(("error", "told"), [(-0.228, "-0.23 %"), (0.06, "+0.06 %"), (-0.04, None)])
def test_a_mesh_that_misses_the_shape_is_told(error, told):
    lines = list(too_coarse(RodElements.model_construct(volume_error_percent=error)))
    assert len(lines) == (told is not None)
    assert all(told in line and "smaller elements" in line for line in lines)
