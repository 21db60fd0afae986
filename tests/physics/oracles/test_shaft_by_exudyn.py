"""The reduced shaft as a flexible body in Exudyn, a code of multibody dynamics: its natural frequencies.

Needs the test extra `oracles`.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.design.loading import load_scene
from cranktopo.numerics.turning_body import TurningBody, modes_at_rest
from cranktopo.tasks.modes import stage
from cranktopo.tasks.throw_fea.targets import Target

Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def exudyn() -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return pytest.importorskip("exudyn", reason="needs Exudyn: pip install cranktopo[oracles]")


def exudyn_Hz(exudyn: Any, body: TurningBody) -> Array:
    """Frequencies of a body over generic coordinates, in unknowns by which all masses are 1."""
    from exudyn.itemInterface import NodeGenericODE2, ObjectGenericODE2

    count, scale = len(body.mass), 1 / np.sqrt(np.diag(body.mass))
    system = exudyn.SystemContainer().AddSystem()
    none = [0.0] * count
    node = system.AddNode(
        NodeGenericODE2(
            numberOfODE2Coordinates=count,
            referenceCoordinates=none,
            initialCoordinates=none,
            initialCoordinates_t=none,
        )
    )
    mass, stiffness = (matrix * np.outer(scale, scale) for matrix in (body.mass, body.stiffness))
    system.AddObject(ObjectGenericODE2(nodeNumbers=[node], massMatrix=mass, stiffnessMatrix=stiffness))
    system.Assemble()
    squares, _ = system.ComputeODE2Eigenvalues()
    return np.asarray(np.sqrt(np.abs(squares)) / (2 * np.pi))


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_natural_frequencies_of_a_reduced_shaft(exudyn: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """The Mikron in rigid bearings: ten modes beyond those of the body as a whole."""
    models, make = list[TurningBody](), stage.shaft_model

    def kept(*args: Any) -> Any:
        model = make(*args)
        models.append(model.body)
        return model

    monkeypatch.setattr(stage, "shaft_model", kept)
    scene = load_scene("mikron-iiic", whole=True)
    told = stage.shaft_modes(Target("mikron", scene), "rigid", 24.0, speeds_rpm=(700.0,))
    rest = modes_at_rest(models[0])
    found = exudyn_Hz(exudyn, models[0])[rest.rigid : rest.rigid + 10]
    assert found == pytest.approx(rest.frequency_Hz[rest.rigid : rest.rigid + 10], rel=1e-5)
    assert found[: len(told.modes)] == pytest.approx([one.frequency_Hz for one in told.modes][:10], rel=1e-3)
