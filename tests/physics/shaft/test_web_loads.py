"""Loads of a web of a shaft as forces on a throw that stands alone: where these are known, they are those."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.histories import LoadHistory, WebHistory, load_history
from cranktopo.tasks.shaft.cycle import cycle_forces, shaft_cycle
from cranktopo.tasks.shaft.loaded_throw import LoadedThrow, loaded_throw, throw_body
from cranktopo.tasks.shaft.web_loads import web_histories

FOUR = load_scene("mikron-iiic")
ONE = with_values(FOUR, {"engine.cylinders": 1, "engine.firing_order": [1]})
_ALL = frozenset({"bending", "tangential", "torsion", "centrifugal"}) | INERTIA_EFFECTS


@pytest.fixture(scope="module")
def throw() -> LoadedThrow:
    return loaded_throw(throw_body(mesh_throw(ONE, 12.0), ONE).blocks, ONE)


def differs(one: LoadHistory, other: LoadHistory, turned: float = 1.0) -> float:
    """Largest difference of forces and torque, of their size; `turned` is the sign of the torque."""
    pairs = [
        (one.radial_N, other.radial_N),
        (one.tangential_N, other.tangential_N),
        (one.torque_Nm, turned * other.torque_Nm),
    ]
    assert isinstance(one, WebHistory)
    assert max(np.abs(one.moment_Nm).max(), np.abs(one.side_moment_Nm).max()) < 1e-6  # bearings tilt
    return max(float(np.abs(a - b).max() / np.abs(b).max()) for a, b in pairs)


def test_a_throw_between_two_bearings_has_the_loads_of_its_pin(throw: LoadedThrow) -> None:
    """Statics decide there, whatever the stiffness; gas, rods and torque come by another way in `engine`.

    The web beyond the pin is told in the axes of the near one, where a torque turns its sign.
    """
    forces = cycle_forces(ONE)
    near, far = web_histories([throw], [ONE], forces, shaft_cycle([throw], (0.0,), forces, None))
    own = load_history(ONE, "cycle", _ALL)
    assert differs(near, own) < 1e-9
    assert differs(far, own, turned=-1.0) < 5e-3  # torque: the middle of the meshed pin is not quite at r


def test_a_shaft_that_is_turned_around_has_the_loads_of_the_other_end(throw: LoadedThrow) -> None:
    """Torque goes to the output, so neither that nor what it does across a throw is its own image."""
    forces, angles = cycle_forces(FOUR), FOUR.shaft_angles_deg
    webs = web_histories([throw] * 4, [FOUR] * 4, forces, shaft_cycle([throw] * 4, angles, forces, None))
    assert [history.labels[0] for history in webs] == [f"web {n}, 0 deg" for n in range(1, 9)]
    # Cylinders 1 and 4 fire 360 deg apart, and so do 2 and 3: the mirrored web has the same a turn later.
    for web in range(4):
        one, other = webs[web], webs[7 - web]
        for name in ("radial_N", "moment_Nm"):
            own, later = getattr(one, name), np.roll(getattr(other, name), len(one.labels) // 2)
            assert np.abs(later - own).max() < 1e-6 * np.abs(webs[1].moment_Nm).max()
    torques = [ONE.throw.radius_mm * own.tangential_N / 2e3 - own.torque_Nm for own in webs]
    assert np.abs(torques[0]).max() < 1e-6  # the free end
    assert np.ptp(torques[7]) > 600
