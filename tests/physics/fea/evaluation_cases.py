"""Throws and models shared by the tests of the body-fitted evaluation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.base.units import MPA_PER_GPA
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble
from cranktopo.numerics.tetrahedra.mesh import TetMesh

LOPSIDED = {"shape": "cylinder", "x_mm": 15.0, "y_mm": 20.0, "diameter_mm": 14.0}
"""A hole beside the mirror plane of the Mikron's web."""


def mikron_with(fillet_mm: float = 2.5, bore_mm: float = 24.0, **web: Any) -> Scene:
    """The Mikron throw with other fillets, bores and entries of its web table."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    for journal in ("main_journal", "crankpin"):
        data["throw"][journal] |= {"fillet_mm": fillet_mm, "bore_diameter_mm": bore_mm}
    data["web"] |= web
    return scene_from_dict(data)


def throw_scene(throw: Mapping[str, Any], web: Mapping[str, Any]) -> Scene:
    """A scene of one throw in the reference steel, E = 210 GPa."""
    return scene_from_dict(
        {"name": "throw", "throw": dict(throw), "web": dict(web), "material": {"name": "31CrMoV9"}}
    )


def elastic(mesh: TetMesh, scene: Scene) -> Elasticity:
    """The assembled model of a mesh."""
    return assemble(mesh, scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson)
