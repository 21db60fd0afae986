"""Quadratic tetrahedra on the solid of a throw: graded toward fillets, curved, never inverted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.frames import Parity, Span
from cranktopo.bodies.solid.checked import SolidProperties, check_parts, solid_properties, volume_mm3
from cranktopo.bodies.solid.throw import add_full_throw, add_half_throw, half_form, throw_form
from cranktopo.bodies.volume import web_volume_mm3
from cranktopo.design.crank_throws import refuse_flying_web, refuse_split_pins
from cranktopo.design.halves import difference, halves, may_mirror, usual_scale, web_asymmetry
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import body_session
from cranktopo.numerics.tetrahedra.cad_mesh import by_smaller_elements, generate, positive_x
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.throw.drilling.bore import size_mm, size_terms
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.element_size import GROWTH, tube_term
from cranktopo.throw.journal import FilletSection
from cranktopo.throw.side_slots import SideSlots
from cranktopo.throw.web import web_bodies

if TYPE_CHECKING:
    from cranktopo.numerics.tetrahedra.earlier_bodies import EarlierBodies
    from cranktopo.numerics.tetrahedra.followed_mesh import FollowedMesh

_R = TypeVar("_R")
FITTED_FRACTION = 0.2
"""Element size on a fillet over its radius up to which stresses are those of fitted polynomials: they smooth
the scatter of irregular elements, and follow a fillet that is not much longer than their two rings."""
_FINEST = 1 / 12
"""Element size at a sharp re-entrant ring over the general one."""
_FLOOR_FRACTION = 1 / 3
"""Least element size on the round edge of a floor over its radius: five on its arc of about 90 degrees."""
_ROUND_MM = 8.0
"""Fillet of a throw of usual size, others in proportion, that the general element size suits."""


@dataclass(frozen=True)
class MeshedThrow:
    """A meshed half throw, or `whole` one; exact properties for both signs of x, volume of the first web.

    The note says what was done to a body from CAD before it was meshed; the element size is the one that gave
    a mesh, where the one that was asked for did not, None where only that was tried.
    """

    mesh: TetMesh
    body: SolidProperties
    web_volume_mm3: float
    note: str = ""
    whole: bool = False
    element_size_mm: float | None = None
    followed: FollowedBody | None = None

    @property
    def earlier(self) -> EarlierBodies | None:
        """Bodies that were solved on its elements, if others follow it."""
        return self.followed.earlier if self.followed else None

    @property
    def copies(self) -> int:
        """Number of such bodies in the throw."""
        return 1 if self.whole else 2

    def span(self, parity: Parity) -> Span:
        """Return what a motion of a parity is condensed from: a whole throw has no parity."""
        return "whole" if self.whole else parity


def mesh_throw(
    scene: Scene,
    element_size_mm: float,
    *,
    full: bool = False,
    quarter: bool = True,
    graded: bool = True,
    fillet_fraction: float | None = None,
    regular: bool = False,
    to_follow: bool = False,
) -> MeshedThrow:
    """Return the mesh of the half throw, of the whole one where its halves differ; of x >= 0 where symmetric.

    Args:
        element_size_mm: general element size; fillets and sharp rings get a fixed fraction of it.
        full: mesh the whole throw although its halves are alike (to check the condensation).
        fillet_fraction: element size on a fillet over its least radius; by default what stiffness needs.
        regular: with Netgen's optimiser, for stresses that are not those of fitted polynomials.
        to_follow: keep where its nodes lie, for `follow_throw`.
    """
    refuse_flying_web(scene)
    refuse_split_pins(scene)
    whole = full or bool(difference(scene))
    mirrored = quarter and may_mirror(scene, web_asymmetry(scene))

    def make(size: float, adapt: bool, by_tools: bool = False) -> MeshedThrow:
        body_of = _Body(_solid_scene(scene), whole, mirrored, by_tools)
        with body_session(f"solid of {scene.name}", body_of, body_of.build) as (gmsh, body):
            _set_sizes(gmsh, scene, size, graded=graded, full=whole, fillet_fraction=fillet_fraction)
            stresses, regular_too = _for_stress(fillet_fraction, regular=regular)
            mesh = generate(gmsh, mirrored, stresses=stresses, regular=regular_too, adapt=adapt)
            kept = _followed(gmsh, body_of, mesh) if to_follow else None
        web = web_volume_mm3(halves(scene)[0])
        return MeshedThrow(mesh, body, web, whole=whole, element_size_mm=size, followed=kept)

    return drilled_mesh(f"solid of {scene.name}", element_size_mm, make, drilled=bool(scene.throw.drilling))


def drilled_mesh(what: str, element_size_mm: float, make: Callable[..., _R], *, drilled: bool) -> _R:
    """Return what `by_smaller_elements` does; a drilled body without a mesh is cut by tools and tried again.

    Args:
        make: as there, and given `by_tools=True` as that of `drilled` then.
    """
    try:
        return by_smaller_elements(what, element_size_mm, make)
    except CranktopoError as error:
        if error.code != ExitCode.SOLVER or not drilled:
            raise
        return by_smaller_elements(what, element_size_mm, partial(make, by_tools=True))


def follow_throw(meshed: MeshedThrow, scene: Scene) -> MeshedThrow | None:
    """Return a mesh that was made `to_follow` on the body of other dimensions; None where it needs another.

    Raises:
        CranktopoError: impossible geometry.
    """
    kept = meshed.followed
    mirrored = may_mirror(scene, web_asymmetry(scene))
    if kept is None or (bool(difference(scene)), mirrored) != (kept.body.whole, kept.body.mirrored):
        return None
    body_of = replace(kept.body, scene=_solid_scene(scene))
    with body_session(f"solid of {scene.name}", body_of, body_of.build) as (gmsh, body):
        gmsh.model.occ.synchronize()
        mesh = kept.mesh.at(gmsh)
    if mesh is None:
        return None
    return replace(meshed, mesh=mesh, body=body, web_volume_mm3=web_volume_mm3(halves(scene)[0]))


def _solid_scene(scene: Scene) -> Scene:
    """Return what of a scene its solid is built from."""
    return scene.model_copy(update={"shaft": None})


@dataclass(frozen=True)
class FollowedBody:
    """The body that a mesh was made on, and where the nodes lie on it."""

    body: _Body
    mesh: FollowedMesh
    earlier: EarlierBodies


def _followed(gmsh: Any, body: _Body, mesh: TetMesh) -> FollowedBody:
    """Return where the nodes of a new mesh lie; its libraries are loaded here, as `evaluate` needs none."""
    from cranktopo.numerics.tetrahedra.earlier_bodies import EarlierBodies
    from cranktopo.numerics.tetrahedra.followed_mesh import followed_mesh

    return FollowedBody(body, followed_mesh(gmsh, mesh), EarlierBodies())


@dataclass(frozen=True)
class _Body:
    """The half or the whole throw of a scene, or its half x >= 0, to be meshed."""

    scene: Scene
    whole: bool
    mirrored: bool
    by_tools: bool

    def build(self, gmsh: Any) -> SolidProperties:
        """Build it in an open session; return the properties for both signs of x."""
        occ, scene = gmsh.model.occ, self.scene
        solid = (add_full_throw if self.whole else add_half_throw)(occ, scene, by_tools=self.by_tools)
        properties = solid_properties(occ, solid, (throw_form if self.whole else half_form)(scene))
        if self.mirrored:
            both = volume_mm3(occ, solid)
            check_parts(2 * volume_mm3(occ, positive_x(occ, solid, scene.pitch_mm)), both)
        return properties


def mesh_body(
    gmsh: Any,
    scene: Scene,
    element_size_mm: float,
    *,
    mirrored: bool,
    full: bool = False,
    fillet_fraction: float | None = None,
    regular: bool = False,
    adapt: bool = False,
) -> TetMesh:
    """Return the mesh of whatever body the open session holds.

    Args:
        mirrored: it is the half x >= 0 of one.
        full: it is a whole throw.
        fillet_fraction, regular: as in `mesh_throw`.
        adapt: as in `generate`.
    """
    _set_sizes(gmsh, scene, element_size_mm, graded=True, full=full, fillet_fraction=fillet_fraction)
    stresses, regular = _for_stress(fillet_fraction, regular=regular)
    return generate(gmsh, mirrored, stresses=stresses, regular=regular, adapt=adapt)


def serves_polynomials(fillet_fraction: float | None) -> bool:
    """Tell whether elements of this size in a fillet over its radius are fine enough for fitted stresses."""
    return fillet_fraction is not None and fillet_fraction <= FITTED_FRACTION


def _for_stress(fillet_fraction: float | None, *, regular: bool) -> tuple[bool, bool]:
    """Return whether stresses are wanted, and whether they ask for regular elements."""
    return fillet_fraction is not None, regular or not serves_polynomials(fillet_fraction)


def _set_sizes(
    gmsh: Any, scene: Scene, size: float, *, graded: bool, full: bool, fillet_fraction: float | None = None
) -> None:
    """One analytic size field: distance to each fillet surface (or sharp ring), growing linearly."""
    gmsh.model.occ.synchronize()
    terms = [f"{size!r}"]
    if graded:
        rings = _rings(scene, full)
        terms += [_ring_size(finest_mm(scene, size, ring[-1], fillet_fraction), *ring) for ring in rings]
    heights = ("z", f"({scene.pitch_mm!r}-z)")[: 1 + full]
    for z, half in zip(heights, halves(scene), strict=False):
        for bore in drill_bores(half):
            terms += size_terms(bore, size, fillet_fraction, z)
        for body in web_bodies(half) if graded else ():
            if isinstance(body, SideSlots) and body.floor_radius_mm:
                terms.append(body.size_term(_at_floor(scene, size, body.floor_radius_mm, fillet_fraction), z))
    set_size_field(gmsh, terms)


def set_size_field(gmsh: Any, terms: Sequence[str]) -> None:
    """Make the least of some formulae in x, y, z the element size of the open session, mm."""
    text = terms[0]
    for term in terms[1:]:
        text = f"Min({text}, {term})"
    field = gmsh.model.mesh.field.add("MathEval")
    gmsh.model.mesh.field.setString(field, "F", text)
    gmsh.model.mesh.field.setAsBackgroundMesh(field)
    for option in ("MeshSizeFromPoints", "MeshSizeExtendFromBoundary", "MeshSizeFromCurvature"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)


def _rings(scene: Scene, full: bool) -> list[tuple[float, float, float, FilletSection]]:
    """Per web face: y of the axis, radius and z of the fillet's centre circle, mm; its section."""
    near, far = halves(scene)
    beyond = [(y, r, scene.pitch_mm - z, f) for y, r, z, f in _half_rings(far)] if full else []
    return _half_rings(near) + beyond


def _half_rings(scene: Scene) -> list[tuple[float, float, float, FilletSection]]:
    throw, (start, end) = scene.throw, scene.web_z_mm
    main, pin = throw.main_journal, throw.crankpin
    return [
        (0.0, main.radius_mm + main.fillet_mm, start - main.fillet.reach_mm, main.fillet),
        (throw.radius_mm, pin.radius_mm + pin.fillet_mm, end + pin.fillet.reach_mm, pin.fillet),
    ]


def _ring_size(finest: float, y: float, radius: float, z: float, fillet: FilletSection) -> str:
    across = f"(Sqrt(x*x+(y-({y!r}))*(y-({y!r})))-{radius!r})"
    return tube_term(finest, across, f"({fillet.flattening!r}*(z-({z!r})))", fillet.radial_mm)


def ring_size_mm(scene: Scene, size: float, points_mm: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return element sizes at points (n,), mm: finer toward fillets, sharp rings and drillings."""
    x, y, z = points_mm.T
    result = np.full(len(points_mm), size)
    for bore in drill_bores(scene):
        result = np.minimum(result, size_mm(bore, size, points_mm))
    for axis_y, radius, centre_z, fillet in _rings(scene, full=False):
        away = np.abs(fillet.off_mm(np.hypot(x, y - axis_y) - radius, z - centre_z))
        result = np.minimum(result, finest_mm(scene, size, fillet) + GROWTH * away)
    return result


def finest_mm(scene: Scene, size: float, fillet: FilletSection, fraction: float | None = None) -> float:
    """Return the element size at a fillet or sharp ring, mm; `fraction` of its radius where given."""
    if fraction is not None and fillet.radial_mm:
        return min(size, fraction * fillet.least_radius_mm)
    return size * min(1.0, max(usual_scale(scene) * fillet.shorter_mm / _ROUND_MM, _FINEST))


def _at_floor(scene: Scene, size: float, radius_mm: float, fraction: float | None) -> float:
    """Return the element size at the round edge of a floor, less steeply stressed than a fillet."""
    if fraction is not None:
        return min(size, max(fraction, _FLOOR_FRACTION) * radius_mm)
    return size * min(1.0, max(usual_scale(scene) * radius_mm / _ROUND_MM, _FINEST))
