"""Does a body-fitted mesh fit into memory? Asked before it is made."""

from __future__ import annotations

import math

from cranktopo.base.errors import invalid
from cranktopo.bodies.cells.resolution import available_memory_MiB
from cranktopo.bodies.volume import web_volume_mm3
from cranktopo.design.halves import halves, may_mirror, web_asymmetry
from cranktopo.design.schema import Scene

# Measured from 4.2 to 1.9 mm: 16.0 to 14.9 KiB per node over 120 MiB; 25 to 12 nodes per cubed element size.
BASE_MIB = 120.0
_PER_NODE_KIB = 15.0
_LEAST_NODES = 10.0
"""Nodes per cubed element size of a quadratic mesh without any refinement."""


def check_element_size(scene: Scene, element_size_mm: float) -> None:
    """Check that the mesh of a throw can fit into the memory.

    The estimate leaves out what is refined at fillets, so that nothing is refused which would fit.

    Raises:
        CranktopoError: it cannot, with the finest size that may.
    """
    available = available_memory_MiB()
    needed = evaluation_memory_MiB(scene, element_size_mm)
    if needed <= available:
        return
    finest = element_size_mm * math.cbrt((needed - BASE_MIB) / max(available - BASE_MIB, 1.0))
    raise invalid(
        "element size",
        element_size_mm,
        f"too fine: at least {needed / 1024:,.1f} GiB needed, {available / 1024:,.1f} GiB available",
        f"The finest that may fit is about {finest:.2g} mm (--element-size-mm).",
    )


def evaluation_memory_MiB(scene: Scene, element_size_mm: float) -> float:
    """Least peak memory of an evaluation, MiB: of half of it where the throw is symmetric in x."""
    near, far = halves(scene)
    volume = _half_volume_mm3(near) + (0.0 if far is near else _half_volume_mm3(far))
    share = 0.5 if may_mirror(scene, web_asymmetry(scene)) else 1.0
    nodes = _LEAST_NODES * share * volume / element_size_mm**3
    return BASE_MIB + _PER_NODE_KIB * nodes / 1024


def _half_volume_mm3(scene: Scene) -> float:
    """Volume of a half throw without its fillets."""
    return web_volume_mm3(scene) + sum(
        math.pi * (journal.radius_mm**2 - journal.bore_radius_mm**2) * journal.length_mm / 2
        for journal, _ in scene.throw.journals
    )
