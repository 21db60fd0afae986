"""Volume of a STEP file by the CAD kernel, for tests of what is written."""

from __future__ import annotations

from pathlib import Path

from cranktopo.numerics.gmsh_session import cad_session


def step_volume_mm3(path: Path) -> float:
    """Of all bodies together."""
    with cad_session(str(path)) as gmsh:
        bodies = gmsh.model.occ.importShapes(str(path))
        return sum(float(gmsh.model.occ.getMass(*pair)) for pair in bodies if pair[0] == 3)
