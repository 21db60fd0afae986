"""Fillets whose foot just reaches over a pocket: the CAD kernel leaves none of it on air."""

from __future__ import annotations

from cranktopo.bodies.solid.throw import add_half_throw
from cranktopo.design.halves import mirror_image
from cranktopo.numerics.gmsh_session import cad_session
from tests.featured_throws import featured_throw


def test_no_lens_is_left_over_a_pocket() -> None:
    """16 um thick at most, where points within 0.1 mm/1000 were taken for one to be rid of a short edge."""
    whole = featured_throw(350).with_drillings(())
    few = {"pocket": whole.web.pocket[2:], "bevel": (), "counterweight": None}
    scene = mirror_image(whole.model_copy(update={"web": whole.web.model_copy(update=few)}))
    face = scene.web_z_mm[0]
    with cad_session("half throw") as gmsh:
        ((_, body),) = add_half_throw(gmsh.model.occ, scene)
        gmsh.model.occ.synchronize()
        in_lens, in_fillet = (33.0, -34.3, face - 0.005), (32.5, -34.3, face - 0.005)
        assert not gmsh.model.isInside(3, body, in_lens)
        assert gmsh.model.isInside(3, body, in_fillet)
