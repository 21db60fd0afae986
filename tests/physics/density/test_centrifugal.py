"""Body force of rotation: resultant and mirrors; its derivative is among the gradients."""

from __future__ import annotations

import jax.numpy as jnp
import numpy as np
import pytest

from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.cells.grid import Extent
from cranktopo.design.schema import Scene
from cranktopo.tasks.density.model import build_model, case_forces
from cranktopo.tasks.density.response import compliances, solve
from tests.physics.density.throw_cases import CENTRIFUGAL


def test_resultant_is_unbalance_times_speed_squared(float64: None, mikron: Scene) -> None:
    """Closed form of the half throw without pin force: rho w^2 (web area moment + pin area x r)."""
    case = type(CENTRIFUGAL)(name="centrifugal", kind="centrifugal", speed_rpm=3000.0)
    domain = build_domain(mikron, 2.0, "web", "half")
    model = build_model(mikron, domain, (case,))
    force = np.asarray(case_forces(model, jnp.asarray(domain.passive_fraction)))[0] * model.modulus_MPa
    ring = np.pi * (21.0**2 - 12.0**2)
    web = 19 * (50 * 48 + np.pi * 25**2 - 2 * np.pi * 12**2) * 24  # symmetric about y = 24
    moment = 7850e-12 * (web + 18 * ring * 48)
    speed = 3000 * 2 * np.pi / 60
    assert force[1].sum() == pytest.approx(moment * speed**2, rel=1e-3)
    assert abs(force[0].sum()) < 1e-6 * force[1].sum()


@pytest.mark.slow
def test_extents_agree(float64: None, mikron: Scene) -> None:
    def work(extent: Extent) -> float:
        domain = build_domain(mikron, 4.0, "web", extent)
        model = build_model(mikron, domain, (CENTRIFUGAL,))
        forces = case_forces(model, jnp.asarray(domain.passive_fraction))
        u = solve(model, jnp.asarray(domain.passive_fraction), forces=forces, tolerance=1e-10).displacements
        return float(compliances(model, u, forces)[0])

    assert work("quarter") == pytest.approx(work("half"), rel=1e-6)
    assert work("full") == pytest.approx(work("half"), rel=1e-6)
