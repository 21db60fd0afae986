"""The hard cases: one list for the tests and for the table of `tests.benchmarks.hard_cases`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Protocol

import jax.numpy as jnp
import numpy as np

from cranktopo.bodies.cells.domain import Domain, build_domain
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.load_case import LoadCase
from cranktopo.numerics.grid.boundary_conditions import CaseSupports, build_supports
from cranktopo.numerics.grid.lattice import Lattice
from cranktopo.tasks.density.material import build_interpolation, relative_moduli
from cranktopo.tasks.density.model import ThrowModel, build_model, case_supports
from tests.hard import fields
from tests.hard.oracle import Array, Direct, solve_directly

# What an error must complain about.
ON_VOID, APART, HINGE = "acts where there is no material", "no material joins", "hinges"


class HardCase(Protocol):
    """A field of moduli, its loads and what the solver owes for it.

    Attributes:
        name: for the test's id and the table.
        moduli: relative modulus per cell.
        complaint: what the error says; empty where the solver owes a number.
    """

    @property
    def name(self) -> str: ...
    @property
    def moduli(self) -> Array: ...
    @property
    def complaint(self) -> str: ...

    def model(self) -> ThrowModel:
        """The case as the package's solver takes it; call inside `double_precision()`."""

    def direct(self) -> list[Direct]:
        """Direct solutions of its loads."""


@dataclass(frozen=True)
class Block:
    """A small grid with one load; attributes as of `HardCase`.

    Attributes:
        lattice: the grid.
        supports: of the load.
        levels: halvings that all axes allow.
        forces: nodal forces (3, nodes...); along the edge of the last plane by default.
    """

    name: str
    moduli: Array
    complaint: str = ""
    lattice: Lattice = fields.CUBES
    supports: CaseSupports = fields.CLAMPED
    levels: int = 1
    forces: Array | None = None

    @property
    def loads(self) -> Array:
        """The nodal forces (3, nodes...)."""
        return fields.tip_load(self.lattice) if self.forces is None else self.forces

    def model(self) -> ThrowModel:
        supports, _ = build_supports(self.lattice, (0.0, 0.0), self.levels, (self.supports,))
        load, forces = LoadCase(name="tip", kind="bending", radial_N=1.0), jnp.asarray(self.loads[None])
        return ThrowModel(self.lattice, self.levels, supports, forces, (load,), 1.0, 1.0)

    def direct(self) -> list[Direct]:
        return [solve_directly(self.lattice, (0.0, 0.0), self.supports, self.moduli, self.loads)]


@dataclass(frozen=True)
class Throw:
    """A scene's throw under bending and torsion, its design space filled with blobs; as `HardCase`.

    Attributes:
        scene: the scene.
        resolution_mm: coarse, and such that all throws have the same cells.
    """

    name: str
    scene: Scene
    resolution_mm: float
    complaint: str = ""

    @property
    def domain(self) -> Domain:
        """The cells."""
        return build_domain(self.scene, self.resolution_mm)

    @property
    def moduli(self) -> Array:
        density_chain = build_interpolation(self.domain, 1.0)
        shape = density_chain.design_fraction.shape
        density = jnp.asarray(fields.blobs(0.6, (shape[0], shape[1], shape[2])), float)
        return np.asarray(relative_moduli(density_chain, density))

    def model(self) -> ThrowModel:
        return build_model(self.scene, self.domain, THROW_LOADS)

    def direct(self) -> list[Direct]:
        domain, model, moduli = self.domain, self.model(), self.moduli
        origin = float(domain.grid.x_mm[0]), float(domain.grid.y_mm[0])
        return [
            solve_directly(
                model.lattice,
                origin,
                case_supports(self.scene, domain, case),
                moduli * model.modulus_MPa,
                np.asarray(forces) * model.modulus_MPa,
            )
            for case, forces in zip(THROW_LOADS, model.forces, strict=True)
        ]


THROW_LOADS = (
    LoadCase(name="bending", kind="bending", radial_N=30e3),
    LoadCase(name="torsion", kind="torsion", torque_Nm=600.0),
)


@cache
def cases() -> dict[str, HardCase]:
    """All hard cases by name."""
    listed = [*_contrasts(), *_volumes(), *_shapes(), *_meaningless(), *_grids(), *_scales(), *_throws()]
    return {case.name: case for case in listed}


def _void(modulus: float) -> str:
    return f"void {modulus:.0e}" if modulus else "void 0"


def _contrasts() -> Iterator[HardCase]:
    solid = fields.blobs(0.4)
    for void in (1e-1, 1e-3, 1e-6, 1e-9, 1e-12, 0.0):
        yield Block(f"blobs 0.4, {_void(void)}", fields.two_phase(solid, void))
    for volume, void in ((0.3, 1e-3), (0.3, 1e-6), (0.3, 1e-9), (0.5, 1e-9), (0.5, 1e-12), (0.7, 1e-9)):
        field = fields.two_phase(fields.random_cells(volume), void)
        yield Block(f"random 0/1 cells {volume:g}, {_void(void)}", field)


def _volumes() -> Iterator[HardCase]:
    """Grey and thresholded; 0.02 of blobs has no load path and is among the meaningless."""
    for density in (0.02, 0.1, 0.3, 1.0):
        yield Block(f"uniform density {density:g}", fields.simp(density))
    for volume in (0.1, 0.2, 0.6):
        yield Block(f"blobs {volume:g}, void 1e-09", fields.two_phase(fields.blobs(volume), 1e-9))


def _shapes() -> Iterator[HardCase]:
    link = fields.blocks_joined((slice(3, 4), slice(5, 6)))
    wall = fields.blocks_joined((slice(3, 4), slice(None)))
    for void in (1e-3, 1e-9):
        yield Block(f"checkerboard, {_void(void)}", fields.two_phase(fields.checkerboard(), void))
        yield Block(f"one-cell walls, {_void(void)}", fields.two_phase(fields.walls(), void))
        yield Block(f"one-cell link, {_void(void)}", fields.two_phase(link, void))
        yield Block(f"one-cell wall as link, {_void(void)}", fields.two_phase(wall, void))
        yield Block(f"island, {_void(void)}", fields.two_phase(fields.island(), void))
    yield Block("hinge of one edge, void 1e-06", fields.two_phase(fields.touching("edge"), 1e-6))
    yield Block("no load path, void 1e-03", fields.two_phase(fields.gap(), 1e-3))
    yield Block("no load path, void 1e-06", fields.two_phase(fields.gap(), 1e-6))
    yield Block("load on void 1e-03", fields.off_material(1e-3))
    field = fields.two_phase(fields.island(), 1e-9)
    yield Block("island, sprung section", field, supports=fields.THROW_LIKE)


def _meaningless() -> Iterator[HardCase]:
    edge, corner = fields.touching("edge"), fields.touching("corner")
    for void in (1e-9, 1e-12, 0.0):
        yield Block(f"no load path, {_void(void)}", fields.two_phase(fields.gap(), void), APART)
        yield Block(f"blobs 0.02, {_void(void)}", fields.two_phase(fields.blobs(0.02), void), APART)
        yield Block(f"hinge of one edge, {_void(void)}", fields.two_phase(edge, void), HINGE)
        yield Block(f"joint at one corner, {_void(void)}", fields.two_phase(corner, void), HINGE)
    for void in (1e-9, 0.0):
        yield Block(f"load on {_void(void)}", fields.off_material(void), ON_VOID)
        yield Block(f"half of the load on {_void(void)}", fields.half_off_material(void), ON_VOID)


def _grids() -> Iterator[HardCase]:
    field = fields.two_phase(fields.blobs(0.4), 1e-9)
    for poisson in (0.0, 0.2, 0.4, 0.49):
        yield Block(f"Poisson {poisson:g}", field, lattice=fields.stretched((1, 1, 1), poisson))
    for aspect in ((4, 1, 1), (1, 4, 1), (1, 1, 4), (1, 1, 0.25), (1, 2, 4)):
        name = ":".join(f"{edge:g}" for edge in aspect)
        yield Block(f"cells {name}", field, lattice=fields.stretched(aspect))
    yield Block("cells 1:1:4, Poisson 0.49", field, lattice=fields.stretched((1, 1, 4), 0.49))
    lattice, levels, body = fields.padded((7, 11, 11))
    moduli = np.where(body, fields.two_phase(fields.blobs(0.5), 1e-9), 0.0)
    load = fields.tip_load(lattice, 7)
    yield Block("7 x 11 x 11 cells, padded", moduli, lattice=lattice, levels=levels, forces=load)


def _scales() -> Iterator[HardCase]:
    field = fields.two_phase(fields.blobs(0.4), 1e-9)
    for size in (1e-3, 1e3):
        yield Block(f"dimensions times {size:g}", field, lattice=fields.stretched((size, size, size)))
    for modulus in (1e-6, 1e6):
        yield Block(f"modulus times {modulus:g}", modulus * field)


def _throws() -> Iterator[HardCase]:
    mikron, opposed = load_scene("mikron-iiic-plain"), load_scene("opposed-piston")
    sprung = {"torsion": "spring", "bending": "spring"}
    yield Throw("throw, journals apart", mikron, 6.4)
    yield Throw("throw, journals overlap", opposed, 7.1)
    supports = opposed.supports.model_copy(update=sprung)
    yield Throw("throw, sprung bearings", opposed.model_copy(update={"supports": supports}), 7.1)
