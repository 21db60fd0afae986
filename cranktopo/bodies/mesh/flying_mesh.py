"""Quadratic tetrahedra on a flying web with its half pins, sized as those of a half throw."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from math import cos, radians, sin
from typing import Any

from cranktopo.bodies.mesh.solid_mesh import drilled_mesh, finest_mm, set_size_field
from cranktopo.bodies.solid.checked import SolidProperties, solid_properties
from cranktopo.bodies.solid.flying_web import add_flying_web
from cranktopo.design.flying_web import FlyingWeb
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import body_session
from cranktopo.numerics.tetrahedra.cad_mesh import generate
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.throw.drilling.bore import size_terms
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.element_size import tube_term


@dataclass(frozen=True)
class MeshedFlyingWeb:
    """Mesh of a flying web, properties of its exact solid, and the element size that gave it."""

    mesh: TetMesh
    body: SolidProperties
    element_size_mm: float


def mesh_flying_web(web: FlyingWeb, element_size_mm: float) -> MeshedFlyingWeb:
    """Return the mesh of a flying web, z = 0 in the middle of the near crankpin.

    Raises:
        CranktopoError: impossible geometry, or no valid mesh.
    """

    def make(size: float, adapt: bool, by_tools: bool = False) -> MeshedFlyingWeb:
        body_of = _FlyingBody(web, by_tools)
        with body_session(web.name, body_of, body_of.build) as (gmsh, body):
            gmsh.model.occ.synchronize()
            set_size_field(gmsh, [repr(size), *_terms(web, size)])
            mesh = generate(gmsh, False, stresses=False, regular=True, adapt=adapt)
        return MeshedFlyingWeb(mesh, body, size)

    drilled = bool(web.near.throw.drilling or web.far.throw.drilling)
    return drilled_mesh(web.name, element_size_mm, make, drilled=drilled)


@dataclass(frozen=True)
class _FlyingBody:
    web: FlyingWeb
    by_tools: bool

    def build(self, gmsh: Any) -> SolidProperties:
        occ = gmsh.model.occ
        return solid_properties(occ, add_flying_web(occ, self.web, by_tools=self.by_tools))


def _terms(web: FlyingWeb, size: float) -> Iterator[str]:
    """Yield formulae of the element size at fillets and drillings of both half throws, each in its place."""
    turn = radians(web.turn_deg)
    along, across = f"(x*({cos(turn)!r})-y*({sin(turn)!r}))", f"(x*({sin(turn)!r})+y*({cos(turn)!r}))"
    yield from _half_terms(web.near, size, f"({web.back_mm!r}-z)")
    for term in _half_terms(web.far, size, f"(z-({web.back_mm!r}))"):
        yield re.sub(r"\b[xy]\b", lambda found: along if found[0] == "x" else across, term)


def _half_terms(half: Scene, size: float, height: str) -> Iterator[str]:
    """Yield them in x and y of a half throw's own frame, and a formula of its height in it."""
    pin, radius, face = half.throw.crankpin, half.throw.radius_mm, half.web_z_mm[1]
    ring = f"(Sqrt(x*x+(y-{radius!r})*(y-{radius!r}))-{pin.radius_mm + pin.fillet_mm!r})"
    at_fillet = f"({pin.fillet.flattening!r}*({height}-{face + pin.fillet.reach_mm!r}))"
    yield tube_term(finest_mm(half, size, pin.fillet), ring, at_fillet, pin.fillet.radial_mm)
    for bore in drill_bores(half):
        yield from size_terms(bore, size, None, height)
