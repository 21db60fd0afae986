"""Is a resolution or an element size usable? Asked before anything is made: memory, and walls of journals."""

from __future__ import annotations

import math
from collections.abc import Callable

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.base.machine import addresses_left_MiB, addresses_of_threads_MiB, container_memory_left_MiB
from cranktopo.bodies.cells.domain import laterally_symmetric, throw_ranges_mm
from cranktopo.bodies.cells.layers import GridContent
from cranktopo.bodies.volume import web_volume_mm3
from cranktopo.design.halves import halves, may_mirror, web_asymmetry
from cranktopo.design.schema import Scene

WALL_CELLS = 2
# Peak memory of a process: BASE + PER_CELL x cells x load cases lies above everything measured, 3 to 0.8 mm
# with two and with four load cases, nothing compiled before (`python -m tests.benchmarks.memory`).
_BASE_MIB = 1250.0
_PER_CELL_KIB = 0.5
_MIB = 1024.0**2
_ADDRESSED_MIB = 2060.0
"""Addresses that a process takes beyond the memory that it uses and its threads (libraries, heaps).
Measured with the threads of two cores: 1050 (evaluate) to 2130 (fatigue)."""
_RAISE = "Close other programs, or allow more memory (container, ulimit -v)."


def check_resolution(scene: Scene, resolution_mm: float, cases: int, available_MiB: float) -> None:
    """Check a cell size against the thinnest wall and the memory; the error names what would do."""
    key = "optimise.resolution_mm"
    wall = thinnest_wall_mm(scene)
    if resolution_mm > wall / WALL_CELLS:
        raise invalid(
            key,
            resolution_mm,
            f"too coarse: the thinnest journal wall is {wall:g} mm and needs {WALL_CELLS} cells",
            f"Use at most {wall / WALL_CELLS:g} mm.",
        )
    quarter = laterally_symmetric(scene, "envelope")
    needed = optimiser_memory_MiB(scene, resolution_mm, quarter, cases)
    _check_base("cells of any size", _BASE_MIB, available_MiB)
    if needed > available_MiB:
        finest = finest_resolution_mm(scene, quarter, cases, available_MiB)
        raise invalid(
            key,
            resolution_mm,
            f"too fine: about {needed / 1024:,.1f} GiB needed, {available_MiB / 1024:,.1f} GiB available",
            f"The finest that fits is about {finest:g} mm.",
        )


def _check_base(what: str, base_MiB: float, available_MiB: float) -> None:
    if base_MiB >= available_MiB:
        amounts = f"{base_MiB / 1024:,.1f} GiB needed, {available_MiB / 1024:,.1f} GiB available"
        raise CranktopoError(f"memory: {what} do not fit: {amounts}.", hint=_RAISE)


def thinnest_wall_mm(scene: Scene) -> float:
    """Return the thinnest radial wall of the two journals (radius of a solid one), mm."""
    journals = scene.throw.main_journal, scene.throw.crankpin
    return min(journal.radius_mm - journal.bore_radius_mm for journal in journals)


def optimiser_memory_MiB(scene: Scene, resolution_mm: float, quarter: bool, cases: int) -> float:
    """Estimate the peak memory of an optimisation, of half a model if `quarter`, at a cell size, MiB."""
    return _BASE_MIB + _PER_CELL_KIB * estimated_cells(scene, resolution_mm, quarter) * cases / 1024


def estimated_cells(
    scene: Scene, resolution_mm: float, quarter: bool, target: GridContent = "envelope"
) -> float:
    """Return the number of cells of a grid, of half a model if `quarter`, at a cell size, without padding."""
    (x0, x1), (y0, y1) = throw_ranges_mm(scene, target)
    width = x1 if quarter else x1 - x0
    return width * (y1 - y0) * scene.pitch_mm / 2 / resolution_mm**3


def finest_resolution_mm(scene: Scene, quarter: bool, cases: int, available_MiB: float) -> float:
    """Return the finest cell size, rounded up to 0.01 mm, whose estimate fits into the memory."""
    at_one = optimiser_memory_MiB(scene, 1.0, quarter, cases) - _BASE_MIB
    room = max(available_MiB - _BASE_MIB, 1e-3)
    return math.ceil(math.cbrt(at_one / room) * 100) / 100


def available_memory_MiB() -> float:
    """Return the memory that a process may take now, MiB: of the machine, the container and `ulimit -v`."""
    import psutil

    of_machine = float(psutil.virtual_memory().available) / _MIB
    addresses = addresses_left_MiB() - _ADDRESSED_MIB - addresses_of_threads_MiB()
    return max(min(of_machine, container_memory_left_MiB(), addresses), 0.0)


# Measured from 4.2 to 1.9 mm: 16.0 to 14.9 KiB per node over 120 MiB; 25 to 12 nodes per cubed element size.
_MESH_BASE_MIB = 120.0
_PER_NODE_KIB = 15.0
_LEAST_NODES = 10.0
"""Nodes per cubed element size of a quadratic mesh without any refinement."""


def check_element_size(scene: Scene, element_size_mm: float) -> None:
    """Check that the mesh of a throw can fit into the memory; the error names the finest size that may.

    The estimate leaves out what is refined at fillets, so that nothing is refused which would fit.
    """
    check_mesh_memory(meshed_volume_mm3(scene), element_size_mm)


def check_mesh_memory(volume_mm3: float, element_size_mm: float) -> None:
    """Check that the mesh of a body of this volume can fit into the memory, without what is refined in it."""

    def hint(over: float) -> str:
        finest = element_size_mm * math.cbrt(over)
        return f"The finest that may fit is about {finest:.2g} mm (--element-size-mm)."

    needed = mesh_memory_MiB(volume_mm3, element_size_mm)
    _check_mesh(needed, "element size", element_size_mm, "elements of any size", hint)


def _check_mesh(
    needed_MiB: float, key: str, value: float, any_mesh: str, hint: Callable[[float], str]
) -> None:
    """Check that a mesh that needs so much memory fits.

    Args:
        key, value: what makes the mesh so fine.
        any_mesh: the meshes of which none may fit, in words.
        hint: given how many times the nodes that fit there are, what to do.
    """
    available = available_memory_MiB()
    if needed_MiB <= available:
        return
    _check_base(any_mesh, _MESH_BASE_MIB, available)
    allowed = f"too fine: at least {needed_MiB / 1024:,.1f} GiB needed, {available / 1024:,.1f} GiB available"
    over = (needed_MiB - _MESH_BASE_MIB) / max(available - _MESH_BASE_MIB, 1.0)
    raise invalid(key, value, allowed, hint(over))


def mesh_memory_MiB(volume_mm3: float, element_size_mm: float) -> float:
    """Estimate the minimum peak memory of an evaluation of so much volume, MiB."""
    nodes = _LEAST_NODES * volume_mm3 / element_size_mm**3
    return _MESH_BASE_MIB + _PER_NODE_KIB * nodes / 1024


def meshed_volume_mm3(scene: Scene) -> float:
    """Return the volume of a throw that an evaluation meshes, mm3; half of it where symmetric in x."""
    near, far = halves(scene)
    volume = _half_volume_mm3(near) + (0.0 if far is near else _half_volume_mm3(far))
    return volume * (0.5 if may_mirror(scene, web_asymmetry(scene)) else 1.0)


_STRESS_PER_NODE_KIB = 6.0
"""Least of a solve for stresses (`python -m tests.benchmarks.body_fitted_scale`): fewer fields, a wider
residual than an evaluation."""
_FILLET_NODES = 7.0
"""Least nodes on a fillet and in the depth below, over its area in element sizes: 15 or more were meshed, and
a narrow web has only a part of the circle."""
_COARSEST_FRACTION = 0.5
_FINER = 0.6
"""Power of the number of nodes by which the fillet fraction for them changes: 0.53 to 0.66 were meshed."""


def check_fillet_fraction(scene: Scene, element_size_mm: float, fraction: float) -> None:
    """Check before a mesh for stresses is made that it can fit into the memory; what fits is not refused."""
    check_stress_memory(least_stress_nodes(scene, element_size_mm, fraction), fraction)


def check_stress_memory(nodes: float, fraction: float) -> None:
    """Check that the stresses on so many nodes can fit into the memory; the error names what may.

    Args:
        fraction: element size in a fillet over its radius that gave them.
    """

    def hint(over: float) -> str:
        finest = fraction * over**_FINER
        fits = f"The finest that may fit is about {finest:.2g} (--fillet-fraction). "
        return f"{fits if finest <= _COARSEST_FRACTION else ''}{_RAISE}"

    needed = _MESH_BASE_MIB + _STRESS_PER_NODE_KIB * nodes / 1024
    _check_mesh(needed, "fillet fraction", fraction, "fillets of any fineness", hint)


def least_stress_nodes(scene: Scene, element_size_mm: float, fraction: float) -> float:
    """Return a number of nodes that a mesh for stresses of a throw exceeds."""
    near, far = halves(scene)
    on_fillets = _fillet_nodes(near, fraction) + (0.0 if far is near else _fillet_nodes(far, fraction))
    on_fillets *= 0.5 if may_mirror(scene, web_asymmetry(scene)) else 1.0
    return on_fillets + _LEAST_NODES * meshed_volume_mm3(scene) / element_size_mm**3


def _fillet_nodes(half: Scene, fraction: float) -> float:
    nodes = 0.0
    for journal, _ in half.throw.journals:
        radius = journal.fillet.least_radius_mm
        area = 2 * math.pi * journal.radius_mm * math.pi / 2 * radius
        nodes += _FILLET_NODES * area / (fraction * radius) ** 2 if radius else 0.0
    return nodes


def _half_volume_mm3(scene: Scene) -> float:
    return web_volume_mm3(scene) + sum(
        math.pi * (journal.radius_mm**2 - journal.bore_radius_mm**2) * journal.length_mm / 2
        for journal, _ in scene.throw.journals
    )
