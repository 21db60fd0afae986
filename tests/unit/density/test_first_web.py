"""Settings by which the uniform first web is void, or becomes void before steps have made anything of it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.design.schema import Scene
from cranktopo.numerics.filters.density_filter import Projection
from cranktopo.tasks.density.first_web import check_start
from cranktopo.tasks.density.material import MaterialInterpolation, build_interpolation
from cranktopo.tasks.density.problem import Schedule


@pytest.fixture
def chain(float64: None, mikron: Scene) -> MaterialInterpolation:
    return build_interpolation(build_domain(mikron, 4.0), 8.0)


@pytest.mark.parametrize(
    ("start", "penalty", "schedule"),
    [
        (0.3, 3.0, Schedule()),
        (0.01, 3.0, Schedule()),
        (0.11, 6.0, Schedule()),
        (0.3, 10.0, Schedule()),
        (0.3, 3.0, Schedule(projection_last=1000.0)),
        (0.3, 3.0, Schedule(move=0.01)),
        (0.5, 3.0, Schedule(1000.0, 1000.0, 1, 0.001)),
    ],
)
def test_carries(chain: MaterialInterpolation, start: float, penalty: float, schedule: Schedule) -> None:
    check_start(replace(chain, penalty=penalty), start, schedule)


@pytest.mark.parametrize(
    ("start", "penalty", "schedule", "said"),
    [
        (0.05, 6.0, Schedule(), "volume_fraction = 0.05: the first web is void"),
        (0.3, 3.0, Schedule(1000.0, 1000.0), "volume_fraction = 0.3: the first web is void"),
        (0.3, 3.0, Schedule(move=0.001), "move = 0.001: too short with stage_iterations = 6"),
        (
            0.3,
            3.0,
            Schedule(stage_iterations=1, move=0.02),
            "move = 0.02: too short with stage_iterations = 1",
        ),
    ],
)
def test_carries_nothing(
    chain: MaterialInterpolation, start: float, penalty: float, schedule: Schedule, said: str
) -> None:
    with pytest.raises(CranktopoError, match=said) as caught:
        check_start(replace(chain, penalty=penalty), start, schedule)
    assert caught.value.code == ExitCode.INVALID_INPUT


def test_half_the_density_is_thin_where_members_have_a_least_size(chain: MaterialInterpolation) -> None:
    """The eroded design has its threshold above one half, and its stiffness counts."""
    eroded = replace(chain, projection=Projection(eroded=0.7))
    with pytest.raises(CranktopoError, match="first web is void"):
        check_start(eroded, 0.5, Schedule(64.0, 64.0))
