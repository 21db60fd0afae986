"""The rounding of an outlet that the kernel leaves open at its seam by 6e-4 mm (random throw 113)."""

from __future__ import annotations

import pytest

from cranktopo.bodies.solid import shapes
from cranktopo.bodies.solid.seams import seams_closed
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.primitives import RoundedOutlet
from tests.featured_throws import featured_throw


def test_the_seam_of_a_rounding_is_where_it_closes(monkeypatch: pytest.MonkeyPatch) -> None:
    bore, *_ = drill_bores(featured_throw(113))
    outlet = next(one for one in bore.solids() if isinstance(one, RoundedOutlet) and one.on == "main_journal")
    with cad_session("outlet") as gmsh:
        occ = gmsh.model.occ
        tool = shapes.add_solid(occ, outlet)
        assert seams_closed(occ, tool)
        monkeypatch.setattr(shapes, "seams_closed", lambda *_: True)
        as_it_comes = shapes.add_solid(occ, outlet)
        assert not seams_closed(occ, as_it_comes), "the kernel closes it by itself: the tries can go"
        volumes = [occ.getMass(*pair) for pair in (*tool, *as_it_comes)]
    assert volumes[0] == pytest.approx(volumes[1], rel=1e-3)
