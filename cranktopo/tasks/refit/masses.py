"""Mass and balance of the throw of a re-model, beside those of its body and of the original web."""

from __future__ import annotations

from cranktopo.base.frames import Y
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.volume import bolted_mass
from cranktopo.design.balance_factor import balance_factor_percent
from cranktopo.design.goal.balance_moved import balance_moved
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.tasks.refit.result import RefitThrow, RefitThrows, WebMasses
from cranktopo.tasks.refit.shape_error import ShapeError
from cranktopo.throw.moments import Moments


def throw_masses(run: Scene, fitted: Scene, surface: SurfaceMesh) -> RefitThrows:
    """Return the throws of the original web, of the body and of the fitted web.

    Args:
        run: the run's design, whose web is the original unless a file has it.
        surface: half throw of the body.
    """
    original = None if run.original is not None else throw_of_scene(run)
    found = RefitThrows(original=original, body=throw_of_body(run, surface), fitted=throw_of_scene(fitted))
    if original is None:
        return found
    moved = balance_moved(run, found.fitted.quantities, original.quantities)
    return found.model_copy(update={"moved": moved})


def web_masses(run: Scene, fitted: Scene, near: ShapeError) -> WebMasses:
    """Return the masses of both webs as every command counts them: with what is bolted to them."""
    kg_per_mm3 = density_kg_per_mm3(fitted.material.density_kg_m3)
    web = kg_per_mm3 * near.web_volume_mm3 + bolted_mass(fitted).volume
    body = kg_per_mm3 * near.body_web_volume_mm3 + bolted_mass(run).volume
    return WebMasses(fitted=web, body=body, difference_percent=100 * (web / body - 1))


def throw_of_scene(scene: Scene) -> RefitThrow:
    """Return mass and balance of a design's throw, fillets included."""
    found = throw_balance(scene)
    return RefitThrow(
        mass_kg=found.mass_kg,
        unbalance_kg_mm=found.throw_unbalance_kg_mm,
        balance_factor_percent=found.balance_factor_percent,
    )


def throw_of_body(scene: Scene, surface: SurfaceMesh) -> RefitThrow:
    """Return mass and balance of a throw by the surface of its half, with what is bolted to its webs."""
    steel = Moments(surface.volume_mm3, 0.0, float(surface.first_moments_mm4[Y]), 0.0)
    half = steel.times(density_kg_per_mm3(scene.material.density_kg_m3)) + bolted_mass(scene)
    return RefitThrow(
        mass_kg=2 * half.volume,
        unbalance_kg_mm=2 * half.first_y,
        balance_factor_percent=balance_factor_percent(scene, 2 * half.first_y),
    )
