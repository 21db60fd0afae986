"""A run tells the balance factor of its surface, as `evaluate` does of the run, not that of the cells."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from cranktopo.design.loading import load_scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.tasks.optimise.metrics import _balance_moved


def test_it_is_that_of_the_surface_beside_the_exact_original() -> None:
    """A block of known mass below the crank axis, aside of it and along it."""
    scene = load_scene("industrial-gas")
    engine = scene.engine
    assert engine is not None
    block = trimesh.creation.box([30.0, 50.0, 20.0])
    low_mm = 200.0
    mesh = SurfaceMesh(block.vertices + np.array([3.0, -low_mm, 40.0]), block.faces)
    unbalance = -2 * 30.0 * 50.0 * 20.0 * scene.material.density_kg_m3 * 1e-9 * low_mm
    rods = engine.rods_per_pin * scene.throw.radius_mm
    rotating, oscillating = rods * engine.rod_rotating_kg, rods * engine.reciprocating_kg
    moved, own = _balance_moved(scene, mesh), throw_balance(scene)
    assert moved is not None
    assert moved.original_percent == own.balance_factor_percent
    assert moved.balance_factor_percent == pytest.approx(-100 * (unbalance + rotating) / oscillating)
    assert f"(unbalance {unbalance:.3g} and" in moved.told
