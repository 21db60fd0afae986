"""The written reduced shaft in Exudyn, a code of multibody dynamics, built from the file alone.

Needs the test extra `oracles`.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.numerics.turning_body import modes_at_rest
from cranktopo.tasks.dynamics.moving_throw import moving_throw
from cranktopo.tasks.export import reduced
from cranktopo.tasks.modes.shaft_model import shaft_model
from cranktopo.tasks.shaft.assembly import Bearings
from cranktopo.tasks.throw_fatigue.shaft_stress import solve_shaft_stress
from cranktopo.tasks.throw_fea.targets import Target

Array = NDArray[np.float64]
COARSE, MODES, SPRING_N_PER_MM = 2.0, 10, 3e5


@pytest.fixture(scope="module")
def exudyn() -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return pytest.importorskip("exudyn", reason="needs Exudyn: pip install cranktopo[oracles]")


def exudyn_Hz(exudyn: Any, file: Mapping[str, NDArray[Any]], bearings: Bearings) -> Array:
    """Frequencies on Exudyn's own springs or constraints, over coordinates by which all masses are 1."""
    from exudyn.itemInterface import (
        CoordinateSpringDamper,
        MarkerNodeCoordinate,
        NodeGenericODE2,
        NodePointGround,
        ObjectGenericODE2,
    )

    count, scale = len(file["mass"]), 1 / np.sqrt(np.diag(file["mass"]))
    system, none = exudyn.SystemContainer().AddSystem(), [0.0] * count
    node = system.AddNode(
        NodeGenericODE2(
            numberOfODE2Coordinates=count,
            referenceCoordinates=none,
            initialCoordinates=none,
            initialCoordinates_t=none,
        )
    )
    mass, stiffness = (file[name] * np.outer(scale, scale) for name in ("mass", "stiffness"))
    system.AddObject(ObjectGenericODE2(nodeNumbers=[node], massMatrix=mass, stiffnessMatrix=stiffness))
    radial = file["bearing_coordinates"][:, :2]
    if bearings == "spring":
        ground = system.AddNode(NodePointGround())
        fixed = system.AddMarker(MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
        for row, spring in zip(radial, file["bearing_stiffness_N_per_mm"], strict=True):
            for at in row.tolist():
                moved = system.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=at))
                system.AddObject(
                    CoordinateSpringDamper(
                        markerNumbers=[fixed, moved], stiffness=float(spring) * scale[at] ** 2
                    )
                )
    system.Assemble()
    held = radial.ravel().tolist() if bearings == "rigid" else []
    squares, _ = system.ComputeODE2Eigenvalues(constrainedCoordinates=held)
    return np.asarray(np.sqrt(np.abs(squares)) / (2 * np.pi))


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_natural_frequencies_of_the_written_shaft(exudyn: Any, tmp_path: Path) -> None:
    """The Mikron free, in rigid bearings and on springs: ten modes beyond motions of the whole shaft."""
    data = load_scene("mikron-iiic", whole=True).model_dump(mode="json", exclude_none=True)
    scene = scene_from_dict({**data, "supports": {"bearing_spring_N_per_mm": SPRING_N_PER_MM}})
    reduced.export_reduced(Target("mikron", scene), tmp_path / "shaft.npz", COARSE)
    with np.load(tmp_path / "shaft.npz", allow_pickle=False) as file:
        arrays = dict(file)
    throw = moving_throw(solve_shaft_stress(Target("mikron", scene), COARSE).body, scene, 0.02)
    kinds: dict[Bearings, int] = {"free": 6, "rigid": 2, "spring": 2}
    for bearings, rigid in kinds.items():
        model = shaft_model([throw.reduced] * 4, scene, bearings, SPRING_N_PER_MM)
        rest = modes_at_rest(model.body)
        assert rest.rigid == rigid
        found = exudyn_Hz(exudyn, arrays, bearings)[rigid : rigid + MODES]
        assert found == pytest.approx(rest.frequency_Hz[rigid : rigid + MODES], rel=1e-5)
