"""Outlets of two throws beside the middle of the main journal between them: does the kernel give facets?

`python -m tests.studies.outlets_at_the_middle [SHARE ...]`: a line for each distance of both rims from the
middle over the diameter of the drilling, negative beyond it. The drilling is that of the random engine 11.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence

from cranktopo.bodies.solid.drilled import drilled
from cranktopo.bodies.solid.shapes import fused
from cranktopo.design.loading import scene_from_dict
from cranktopo.numerics.gmsh_session import cad_session, quiet_stdout, triangles
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.throw.drilling.checks import rim_z_mm
from cranktopo.throw.drilling.table import drill_bores
from tests.hostile.featured_engines import featured_engine

SHARES = (1e-3, 1e-5, -1e-5, -3e-5, -1e-4, -1e-3, -3e-3, -4e-3, -5e-3, -6e-3, -8e-3, -12e-3, -2e-2, -0.1)
_FACET = 0.25
"""Facets over half the length of the journal."""


def is_closed(share: float) -> bool:
    """Tell whether two half journals with the outlets of neighbouring throws have closed facets."""
    scene = scene_from_dict(featured_engine(11), whole=True)
    (bore,), journal = drill_bores(scene), scene.throw.main_journal
    bore = bore.moved(2 * share * bore.radius_mm - float(rim_z_mm(bore, bore.outlets[0]).min()))
    other, reach = bore.in_second_half(0.0), journal.length_mm / 2
    with cad_session("journal") as gmsh:
        occ = gmsh.model.occ
        parts = [[(3, occ.addCylinder(0, 0, z, 0, 0, reach, journal.radius_mm))] for z in (-reach, 0)]
        ends = {bore: (0.0, math.inf), other: (-math.inf, 0.0)}
        bodies = drilled(occ, fused(occ, parts, one_face=False), [bore, other], between_mm=ends)
        crumbs = sorted(bodies, key=lambda pair: -occ.getMass(*pair))[1:]
        occ.remove(crumbs, recursive=True)
        occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", _FACET * reach)
        try:
            with quiet_stdout():
                gmsh.model.mesh.generate(2)
        except Exception as error:
            if type(error) is not Exception:  # gmsh raises the bare class; anything else is a defect
                raise
            return False
        return bool(SurfaceMesh(*triangles(gmsh)).as_trimesh().is_watertight)


def main(shares: Sequence[float]) -> None:
    """Print a line for each distance."""
    for share in shares or SHARES:
        print(f"{share:8.0e}  {'closed' if is_closed(share) else 'NOT CLOSED'}", flush=True)


if __name__ == "__main__":
    main([float(word) for word in sys.argv[1:]])
