"""Stress of a throw that vibrates: its fields against its whole mesh, its safety without mass."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as sla
from numpy.typing import NDArray

from cranktopo.base.units import density_tonne_per_mm3
from cranktopo.numerics.tetrahedra.elasticity import mass_matrix
from cranktopo.tasks.dynamics.moving_shaft import MovingShaft, moving_cycle, moving_shaft
from cranktopo.tasks.dynamics.moving_throw import MovingThrow, moving_throw
from cranktopo.tasks.dynamics.stress import moving_factors, moving_stress
from cranktopo.tasks.modes.reduced_throw import reduced_throw, section_shapes
from cranktopo.tasks.shaft.assembly import SPLITS
from cranktopo.tasks.shaft.cycle import CycleForces
from cranktopo.tasks.shaft.loaded_throw import LoadedBlock
from cranktopo.tasks.throw_fatigue.shaft_stress import ShaftStress, solve_shaft_stress
from cranktopo.tasks.throw_fea.targets import Target
from tests.physics.dynamics.shafts import LOSS, body, forces_at, mikron, without_mass
from tests.physics.shaft.test_shaft_safety import COARSE, by_web
from tests.physics.shaft.test_shaft_safety import loads as still_loads

Array = NDArray[np.float64]


@pytest.mark.parametrize(("frequency_Hz", "within"), [(0.0, 1e-6), (500.0, 2e-4), (2000.0, 4e-3)])
def test_fields_of_a_throw_are_those_of_its_mesh(frequency_Hz: float, within: float) -> None:
    """Sections that move as one sees fit and a force on the pin: every node, by all unknowns of the mesh."""
    scene, throw = mikron(), body()
    reduced = reduced_throw(throw, scene, section_shapes(scene, 0), 1, 0.0, with_loads=True)
    mass = mass_matrix(throw.model, density_tonne_per_mm3(scene.material.density_kg_m3))
    square = (2 * np.pi * frequency_Hz) ** 2
    whole = reduced.body.stiffness - square * reduced.body.mass
    section = np.random.default_rng(6).standard_normal(12) * np.tile([1, 1, 1, 0.02, 0.02, 0.02], 2)
    inner = np.arange(12, len(whole))
    names = [name for held in reduced.held for name in held.loads]
    push = np.zeros(len(whole))
    for held in reduced.held:  # the static field of a load tells its force
        for name, unknown in zip(
            held.loads, held.unknowns[len(held.unknowns) - len(held.loads) :], strict=True
        ):
            push += 3e4 * (name in ("radial", "tangential")) * reduced.body.stiffness[:, unknown]
    assert len(names) == 5
    right = push[inner] - whole[np.ix_(inner, np.arange(12))] @ section
    amplitude = np.linalg.solve(whole[np.ix_(inner, inner)], right)
    for part, held in zip(throw.blocks, reduced.held, strict=True):
        block = part.block
        moved = block.displacement[:, : len(block.motions)] @ (
            SPLITS[part.span][list(block.motions)] @ section
        )
        found = moved + held.fields @ amplitude[held.unknowns - 12]
        expected = by_all_unknowns(part, moved, square, mass)
        assert np.abs(found - expected).max() < within * np.abs(expected - moved).max() + 1e-7


def by_all_unknowns(part: LoadedBlock, moved: Array, square: float, mass: sp.csr_matrix) -> Array:
    """Displacement with the sections moved as in a static field, by the mesh's own stiffness and mass."""
    model, held = body().model, part.block.held
    every = sp.kron(mass, sp.eye(3)).tocsr()
    dynamic = (model.stiffness.tocsr() - square * every).tocsr()
    free = np.setdiff1d(np.arange(len(moved)), held)
    fields = dict(zip(part.names, part.load_fields().T, strict=True))
    chosen = [fields[name] for name in ("radial", "tangential") if name in fields]
    force = 3e4 * (model.stiffness @ np.sum(chosen, axis=0)) if chosen else np.zeros(len(moved))
    right = force[free] - (dynamic @ moved)[free]
    found = moved.copy()
    found[free] += sla.spsolve(dynamic[free][:, free].tocsc(), right)
    return found


@pytest.fixture(scope="module")
def stress() -> ShaftStress:
    return solve_shaft_stress(Target("mikron", mikron()), COARSE)


@pytest.fixture(scope="module")
def throw(stress: ShaftStress) -> MovingThrow:
    return moving_throw(stress.body, mikron(), LOSS)


def without_loss(throw: MovingThrow) -> MovingThrow:
    """Springs do not lose what the shaft does, which shifts their share of the forces."""
    damped = replace(throw.damped, loss=np.zeros_like(throw.damped.loss))
    return replace(throw, damped=damped, loss_factor=0.0)


@pytest.fixture(scope="module")
def moving(stress: ShaftStress, throw: MovingThrow) -> ShaftStress:
    return moving_stress(stress, throw, COARSE)


def safety(moving: ShaftStress, shaft: MovingShaft, forces: CycleForces) -> Array:
    """Least safety of pin and journal fillet of every web, (webs, 2, 1)."""
    factors = moving_factors([moving] * len(shaft.throws), moving_cycle(shaft, forces))
    return by_web(moving, [own[None] for own in factors])


@pytest.mark.slow
@pytest.mark.parametrize("spring", [None, 3e5])
def test_without_mass_every_web_is_as_safe_as_it_was(
    stress: ShaftStress, throw: MovingThrow, moving: ShaftStress, spring: float | None
) -> None:
    """And with its mass it is not, at 2,446 rpm, where order 10 meets torsion in rigid bearings."""
    scene = mikron()
    shaft, forces = moving_shaft([throw] * 4, scene, spring), forces_at(scene, 2446.0)
    still = by_web(stress, list(still_loads(stress, scene.shaft_angles_deg, forces, spring)[:, None]))
    same = shaft if spring is None else moving_shaft([without_loss(throw)] * 4, scene, spring)
    light = safety(moving, without_mass(same), forces)
    assert np.abs(light / still - 1).max() < 1e-6
    heavy = safety(moving, shaft, forces)
    assert heavy.min() < (0.8 if spring is None else 0.95) * still.min()
    slow = safety(moving, same, replace(forces, angular_speed_rad_s=1e-3))
    at_rest = replace(forces, angular_speed_rad_s=0.0)
    still = by_web(stress, list(still_loads(stress, scene.shaft_angles_deg, at_rest, spring)[:, None]))
    assert np.abs(slow / still - 1).max() < 1e-6


@pytest.mark.slow
def test_safety_does_not_depend_on_where_the_cycle_begins(throw: MovingThrow, moving: ShaftStress) -> None:
    scene = mikron()
    shaft, forces = moving_shaft([throw] * 4, scene, None), forces_at(scene, 2100.0)
    later = {
        name: np.roll(getattr(forces, name), -136, axis=1)
        for name in ("radial_N", "tangential_N", "radial_aside_N_mm", "tangential_aside_N_mm")
    }
    turned_by = replace(shaft, angles_deg=tuple(angle - 137.3 for angle in shaft.angles_deg))
    one, other = safety(moving, shaft, forces), safety(moving, turned_by, replace(forces, **later))
    assert np.abs(one / other - 1).max() < 1e-9
