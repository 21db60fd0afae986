"""Counterweight opposite the crankpin: a sector about the crank axis that grows out of the web."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache
from typing import Any, Self

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.table import Length
from cranktopo.throw.counterweight.checks import check_edge, check_holes
from cranktopo.throw.counterweight.edge import BevelledEdge, EdgeCut
from cranktopo.throw.counterweight.holes import AxialHole, BalancingHole, DrilledHole, Plug, RadialHole
from cranktopo.throw.counterweight.sector import CornerFillet, Sector
from cranktopo.throw.counterweight.tangent_circle import (
    OutlineSection,
    TangentCircle,
    largest_radius_mm,
    tangent_circle,
)
from cranktopo.throw.feature import (
    SMALLEST,
    SMALLEST_FILLET,
    Body,
    Face,
    Feature,
    Reach,
    ThrowView,
    least_shoulder_mm,
)
from cranktopo.throw.hole import depth_range_mm
from cranktopo.throw.primitives import FeatureDrawing, number_lines

LEAST_HALF_ANGLE_DEG = 5.0
_NO_CORNER_MM = 1e-6
_DRAWN, _SAMPLES = 61, 181
"""Points of the arc in a drawing, and where it is compared with others."""


class Counterweight(Feature):
    """Counterweight opposite the crankpin: a sector about the crank axis, bounded inside by the web itself.

    It is one piece with the web and counts wherever the web does, unless it has a density of its own. Then it
    is a part that is bolted on or let in: its mass, unbalance, inertia and its pull on meshes count, its
    stiffness does not. Cells and meshes leave it out; STEP files of throw and crank have it as a body.
    """

    outer_radius_mm: Length = Field(examples=[60.0])
    """Outer radius about the crank axis; beyond the web's outline, or nothing would be added."""
    half_angle_deg: float = Field(ge=LEAST_HALF_ANGLE_DEG, le=90, examples=[60.0])
    """Angle of each flank to the direction away from the crankpin; 90 = half a disc."""
    thickness_mm: Length | None = Field(default=None, examples=[15.0])
    """Thickness along the crank axis, at most that of the web, which it has by default."""
    face: Face = "journal"
    """Web face with which it is flush if it is thinner than the web."""
    fillet_mm: Length | None = Field(default=None, examples=[3.0])
    """Radius of the fillet between each flank and the side of the web; left out: a sharp corner."""
    corner_mm: Length | None = Field(default=None, examples=[3.0])
    """Radius of the round corner between each flank and the rim; left out: sharp."""
    density_kg_m3: float | None = Field(default=None, ge=10, le=30000, examples=[17500.0])
    """Density of a part that is bolted on or let in, of heavy metal say; left out: one piece with the web."""
    edge: BevelledEdge | None = None
    plug: tuple[Plug, ...] = ()
    hole: tuple[BalancingHole, ...] = ()

    @property
    def bolted(self) -> bool:
        """True if it is a part of its own, which has mass and no stiffness."""
        return self.density_kg_m3 is not None

    @property
    def flank_draft_deg(self) -> float:
        """Draft of its flanks in a die that parts in x = 0, deg."""
        return 90.0 - self.half_angle_deg

    def has_flanks(self, scene: ThrowView) -> bool:
        """Tell whether its flanks reach beyond the web's outline."""
        x, y = self.sector(scene).corner.on_flank
        return x > float(scene.web.half_width_mm(scene.throw.radius_mm, np.array([y]))[0])

    def sector(self, scene: ThrowView, key: str = "web.counterweight") -> Sector:
        """Its body without the fillets to the web."""
        z_mm = depth_range_mm(scene, self.face, self.thickness_mm or scene.web.thickness_mm)
        angle = math.radians(self.half_angle_deg)
        return Sector(key, z_mm, self.outer_radius_mm, angle, self.corner_mm or 0.0)

    def parts(self, scene: ThrowView, key: str = "web.counterweight") -> tuple[Sector | CornerFillet, ...]:
        """Its sector, and the fillets that it has."""
        sector = self.sector(scene, key)
        circle = self.circle(scene)
        return (sector,) if circle is None else (sector, CornerFillet(key, sector.z_mm, circle))

    def drilled(self) -> Iterator[tuple[str, DrilledHole]]:
        """Yield its plugs and balancing holes, each with its key in the table."""
        yield from ((f"plug[{index}]", plug) for index, plug in enumerate(self.plug))
        yield from ((f"hole[{index}]", hole) for index, hole in enumerate(self.hole))

    def holes(self, scene: ThrowView, key: str = "web.counterweight") -> tuple[AxialHole | RadialHole, ...]:
        """Return what is drilled out of it."""
        sector = self.sector(scene, key)
        return tuple(one.body(sector, self.face, f"{key}.{name}") for name, one in self.drilled())

    def bevels(self, scene: ThrowView, key: str = "web.counterweight") -> tuple[EdgeCut, ...]:
        """Return the cuts of its bevelled edge."""
        return () if self.edge is None else self.edge.cuts(self.sector(scene, key), f"{key}.edge")

    def cuts(
        self, scene: ThrowView, key: str = "web.counterweight"
    ) -> tuple[AxialHole | RadialHole | EdgeCut, ...]:
        """Return all that is machined out of it."""
        return (*self.holes(scene, key), *self.bevels(scene, key))

    def circle(self, scene: ThrowView) -> TangentCircle | None:
        """Return the circle of its fillets; None without."""
        if self.fillet_mm is None:
            return None
        half_angle = math.radians(self.half_angle_deg)
        return _circle(scene.web, scene.throw.radius_mm, half_angle, self.fillet_mm)

    def outer_mm(self, scene: ThrowView, points: int = _SAMPLES) -> tuple[Array, Array]:
        """Points of its arc and of its fillet at x >= 0, from the bottom on, which bound what it reaches."""
        rim, circle = self.sector(scene).rim_mm(points), self.circle(scene)
        if circle is None:
            return rim
        x, y = (np.concatenate(pair) for pair in zip(rim, circle.arc_mm(points), strict=True))
        return x, y

    def edge_mm(self, scene: ThrowView) -> tuple[Array, Array]:
        """Points of its arc and, beyond the main journal, of its flank or bevel, at x >= 0."""
        journal, (x, y) = scene.throw.main_journal, self.sector(scene).rim_mm()
        share = np.linspace((journal.radius_mm + journal.fillet_mm) / self.outer_radius_mm, 1.0, _SAMPLES)
        flank_x, flank_y = share * x[-1], share * y[-1]
        for cut in self.bevels(scene)[-1:]:
            along, _ = cut.flank_mm(cut.side * flank_x, flank_y)
            inner_x, inner_y = cut.place_mm(along, cut.width_mm)
            cut_off = along > cut.start_mm
            flank_x, flank_y = (
                np.where(cut_off, cut.side * inner_x, flank_x),
                np.where(cut_off, inner_y, flank_y),
            )
        return np.concatenate([x, flank_x]), np.concatenate([y, flank_y])

    @override
    def bodies(self, scene: ThrowView, key: str) -> tuple[Body, ...]:
        return () if self.bolted else (*self.parts(scene, key), *self.cuts(scene, key))

    @override
    def occupied(self, scene: ThrowView, key: str) -> tuple[Body, ...]:
        return (self.sector(scene, key),)

    @override
    def reach_mm(self, scene: ThrowView, key: str) -> Iterator[Reach]:
        yield f"{key}.outer_radius_mm", self.outer_radius_mm, self.outer_mm(scene)

    @override
    def check_alone(self, scene: ThrowView, key: str) -> None:
        web, journal = scene.web, scene.throw.main_journal
        if self.thickness_mm is not None and self.thickness_mm > web.thickness_mm:
            allowed = f"must be at most web.thickness_mm = {web.thickness_mm:g} mm"
            raise scene.invalid(f"{key}.thickness_mm", allowed, "Leave it out for all of it.")
        least = journal.clear_radius_mm + least_shoulder_mm(scene.throw)
        if self.outer_radius_mm <= least:
            raise scene.invalid(
                f"{key}.outer_radius_mm",
                f"must be larger than {least:.4g} mm, what the main journal needs for its radius and fillet",
                "Enlarge it, or remove the counterweight.",
            )
        self._check_corner(scene, key)
        x, y = self.sector(scene).rim_mm()
        if (x <= web.half_width_mm(scene.throw.radius_mm, y)).all():
            raise scene.invalid(
                f"{key}.outer_radius_mm",
                "lies within the web's outline and adds nothing",
                "Enlarge it, or remove the counterweight.",
            )
        self._check_fillet(scene, key)
        for name, hole in self.drilled():
            found = hole.check(self.sector(scene, key))
            if found is not None:
                raise scene.invalid(f"{key}.{name}.{found[0]}", found[1], "Change or move it.")
        if self.edge is not None:
            circle = self.circle(scene)
            found = self.edge.refusal(scene, self.sector(scene, key), circle.reach_mm if circle else 0.0)
            if found is not None:
                raise scene.invalid(f"{key}.edge.{found[0]}", found[1], "Change the bevelled edge.")

    def _check_corner(self, scene: ThrowView, key: str) -> None:
        """Both round corners are apart, and leave a flank beyond the main journal."""
        sine, outer = math.sin(math.radians(self.half_angle_deg)), self.outer_radius_mm
        journal = scene.throw.main_journal.clear_radius_mm
        most = min(outer * sine / (1 + sine), (outer**2 - journal**2) / (2 * outer))
        if self.corner_mm is not None and self.corner_mm >= most:
            raise scene.invalid(f"{key}.corner_mm", f"must be smaller than {most:.4g} mm", "Reduce it.")

    def _check_fillet(self, scene: ThrowView, key: str) -> None:
        if self.fillet_mm is None:
            return
        if self.bolted:
            allowed = "a part of its own (density_kg_m3) has no fillet to the web"
            raise scene.invalid(f"{key}.fillet_mm", allowed, "Leave one of them out.")
        outline, half_angle = _outline(scene.web, scene.throw.radius_mm), math.radians(self.half_angle_deg)
        flank_mm = math.hypot(*self.sector(scene, key).corner.on_flank)
        largest = largest_radius_mm(outline, half_angle, flank_mm if self.corner_mm else self.outer_radius_mm)
        if largest < _NO_CORNER_MM:
            raise scene.invalid(
                f"{key}.fillet_mm",
                "has no corner: the counterweight's flanks end within the web's outline",
                "Leave it out, or enlarge half_angle_deg or outer_radius_mm.",
            )
        if self.fillet_mm > largest:
            raise scene.invalid(
                f"{key}.fillet_mm",
                f"must be at most {math.floor(largest * 1e3) / 1e3:g} mm: there the flank ends",
                "Reduce it, or enlarge the counterweight.",
            )

    @override
    def check_in_web(self, scene: ThrowView, key: str) -> None:
        """Nothing that is cut from the outline's end or sides runs into it: it would leave a hollow."""
        for name, bevel in enumerate(scene.web.bevel):
            if bevel.face == "pin":
                raise CranktopoError(
                    f"web.bevel[{name}]: bevels the main journal's end of the web, where {key} is.",
                    hint=f"Remove web.bevel[{name}], or leave {key} out.",
                )
        parts = self.parts(scene, key)
        for path, pocket in scene.web.features():
            side = pocket.bodies(scene, path)[:1] if getattr(pocket, "shape", "") == "side" else ()
            if any(_meets(tool, part) for tool in side for part in parts):
                raise CranktopoError(
                    f"{path}: runs into {key}, which is wider than the web's outline there.",
                    hint="Move the pocket toward the crankpin, or narrow the counterweight.",
                )
        parts, holes, bevels = self.parts(scene, key), self.holes(scene, key), self.bevels(scene, key)
        check_holes(scene, key, parts, holes, bevels, self.bolted)
        check_edge(scene, key, bevels, holes)

    @override
    def mirrored(self) -> Self:
        """Its mirror image in x = 0; itself where each of its holes and bevels has its own there."""
        found = {name: tuple(one.mirrored() for one in getattr(self, name)) for name in ("plug", "hole")}
        same = all(set(turned) == set(getattr(self, name)) for name, turned in found.items())
        edge = self.edge and self.edge.mirrored()
        return self if same and edge == self.edge else self.model_copy(update={**found, "edge": edge})

    @override
    def dimensions_mm(self, key: str) -> Iterator[tuple[str, float, float]]:
        yield f"{key}.outer_radius_mm", self.outer_radius_mm, SMALLEST
        yield f"{key}.thickness_mm", self.thickness_mm or 0.0, SMALLEST
        yield f"{key}.fillet_mm", self.fillet_mm or 0.0, SMALLEST_FILLET
        yield f"{key}.corner_mm", self.corner_mm or 0.0, SMALLEST_FILLET
        for name, hole in self.drilled():
            yield f"{key}.{name}.diameter_mm", hole.diameter_mm, SMALLEST
        if self.edge is not None:
            yield from ((f"{key}.edge.{name}", value, SMALLEST) for name, value in self.edge.sizes_mm.items())

    @override
    def drawing(self, scene: ThrowView) -> FeatureDrawing:
        x, y = self.outer_mm(scene, _DRAWN)
        right = list(zip(x.tolist(), y.tolist(), strict=True))
        middle = (0.0, max(0.0, float(y[-1])) if self.fillet_mm else 0.0)
        outer = (middle, *((-a, b) for a, b in right[::-1]), *right)
        numbers = self.model_dump(
            exclude={"face", "density_kg_m3", "edge", "plug", "hole"}, exclude_none=True
        )
        title = (
            "COUNTERWEIGHT"
            if self.thickness_mm is None
            else f"COUNTERWEIGHT, flush with the {self.face} face"
        )
        part = f"   bolted on, {self.density_kg_m3:g} kg/m³" if self.bolted else ""
        holes, sector = [hole for _, hole in self.drilled()], self.sector(scene)
        edges = [] if self.edge is None else [self.edge]
        lines = (*number_lines(title, numbers), *filter(None, [part]))
        lines = (*lines, *(line for edge in edges for line in edge.lines()))
        lines = (*lines, *(line for hole in holes for line in hole.lines()))
        corner = (float(self.edge_mm(scene)[0][_SAMPLES - 1]), float(self.edge_mm(scene)[1][_SAMPLES - 1]))
        named = (
            (right[_DRAWN // 3], f"R{self.outer_radius_mm:g}"),
            (corner, f"2 × {self.half_angle_deg:g}°"),
        )
        bevels = tuple(stroke for edge in edges for stroke in edge.strokes(sector))
        section = next((edge.across(sector) for edge in edges), None)
        return FeatureDrawing(
            front=(*bevels, *(hole.stroke(sector) for hole in holes)),
            added=outer,
            lines=lines,
            places=tuple(place for hole in holes for place in hole.places),
            named=(*named, *(edge.named(sector) for edge in edges)),
            section_y_mm=None if section is None else section[0],
            across=() if section is None else section[1],
        )


@lru_cache(maxsize=16)
def _outline(web: Any, throw_radius_mm: float) -> OutlineSection:
    return OutlineSection(lambda y: web.half_width_mm(throw_radius_mm, y), web.y_range_mm(throw_radius_mm))


@lru_cache(maxsize=64)
def _circle(web: Any, throw_radius_mm: float, half_angle: float, radius_mm: float) -> TangentCircle:
    return tangent_circle(_outline(web, throw_radius_mm), half_angle, radius_mm)


def _meets(slot: Body, part: Sector | CornerFillet) -> bool:
    low, high = (max(slot.z_mm[0], part.z_mm[0]), min(slot.z_mm[1], part.z_mm[1]))
    if low >= high:
        return False
    y = np.linspace(*slot.y_range_mm, 401)
    reach = np.max([end for _, end in slot.spans(y, np.asarray(sum(slot.z_mm) / 2))], axis=0)
    return bool((part.half_width_mm(y) > reach - 1e-9).any())
