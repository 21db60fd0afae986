"""Damping of the shafts beside the crankshaft, against eigenvalues of matrices that are written out here."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.errors import CranktopoError
from cranktopo.design.assumed import VIBRATION, assumptions
from cranktopo.design.checks.engine import is_damped
from cranktopo.design.schema import Scene
from cranktopo.engine.vibration.shaft_chain import ShaftChain, estimated_chain
from cranktopo.tasks.throw_fatigue.dossier_sections import shaft_section
from tests.physics.engine.test_orders_of_a_slow_engine import LOSS, SHAFT, medium_speed

PROPELLER = {"inertia_kg_m2": 700.0, "stiffness_Nm_per_rad": 3.9e6, "damping_Nms_per_rad": 2600.0}
LINE = {name: table for name, table in SHAFT.items() if name != "driven"}
RING_NMS, COUPLING_LOSS, THROW_NM = 30000.0, 0.15, 1.1e8


def ship(**propeller: float) -> Scene:
    return medium_speed(shaft={**LINE, "propeller": PROPELLER | propeller})


def eigenvalues(chain: ShaftChain, losses: dict[str, float]) -> Complex:
    """Of lambda^2 J + lambda C + K, by a generalised problem of twice the size; those that swing, rising."""
    inertia = np.array(chain.chain.inertia_kg_m2)
    count = len(inertia)
    stiffness, viscous = np.zeros((count, count), dtype=complex), np.zeros((count, count))
    for i, (name, k) in enumerate(zip(chain.sections, chain.chain.stiffness_Nm_per_rad, strict=True)):
        pair = np.zeros(count)
        pair[[i, i + 1]] = 1.0, -1.0
        ring = name == "damper ring - hub"
        stiffness += k * (1 + 1j * losses.get(name, 0.0 if ring else LOSS)) * np.outer(pair, pair)
        viscous += (RING_NMS if ring else 0.0) * np.outer(pair, pair)
    viscous[-1, -1] += PROPELLER["damping_Nms_per_rad"]
    one, none = np.eye(count), np.zeros((count, count))
    left = np.block([[none, one], [-stiffness, -viscous]])
    right = np.block([[one, none], [none, np.diag(inertia)]])
    found = scipy.linalg.eigvals(left, right)
    swinging = found[found.imag > 0.1 * np.abs(found)]
    return np.asarray(swinging[np.argsort(np.abs(swinging))])


def check(scene: Scene, propeller_loss: float) -> Array:
    chain = estimated_chain(scene)
    losses = {"flywheel - coupling": COUPLING_LOSS, "coupling - propeller": propeller_loss}
    expected = eigenvalues(chain, losses)
    found = chain.chain.damped_modes()
    assert [mode.frequency_Hz for mode in found] == pytest.approx(np.abs(expected) / (2 * np.pi), rel=1e-6)
    ratios = -expected.real / np.abs(expected)
    assert [mode.damping_ratio for mode in found] == pytest.approx(ratios, rel=1e-5)
    return np.asarray(100 * ratios)


def test_loss_of_the_throws_is_not_that_of_the_propeller_shaft() -> None:
    """A marine six: mode 1 has 8.46 %, mode 2 1.64 %; with the throws' loss factor there 8.67 and 2.43 %."""
    assert check(ship(), 0.0)[:2] == pytest.approx([8.46, 1.64], rel=2e-3)
    assert check(ship(loss_factor=LOSS), LOSS)[:2] == pytest.approx([8.67, 2.43], rel=3e-3)


@pytest.mark.parametrize("part", ["pulley", "flywheel", "driven"])
def test_every_part_has_the_loss_factor_of_its_own_shaft(part: str) -> None:
    """That of the flywheel and of the pulley is in series with half a throw; a spring's loss by hand."""
    own, eta = 5.0e7, 0.07
    table = {"inertia_kg_m2": 300.0, "stiffness_Nm_per_rad": own, "loss_factor": eta}
    shaft = {**SHAFT, "throw_stiffness_Nm_per_rad": THROW_NM, part: table}
    chain = estimated_chain(medium_speed(shaft=shaft))
    half = 2 * THROW_NM * (1 + 1j * LOSS)
    alone = own * (1 + 1j * eta)
    joint = alone if part == "driven" else 1 / (1 / half + 1 / alone)
    ends = {"pulley": "hub + pulley - throw 1", "flywheel": "throw 6 - flywheel"}
    place = chain.sections.index(ends.get(part, "coupling - driven machine"))
    assert chain.chain.stiffness_Nm_per_rad[place] == pytest.approx(joint.real, rel=1e-12)
    assert chain.chain.loss_factor[place] == pytest.approx(joint.imag / joint.real, rel=1e-12)


def test_no_damping_of_a_line_is_told_where_there_is_a_shaft_to_damp() -> None:
    told = {str(one) for one in assumptions(ship(), (VIBRATION,))}
    assert "shaft.propeller.loss_factor = 0 (nothing damps that shaft's twist)" in told
    assert not any("shaft.flywheel.loss_factor" in line for line in told)
    given = {one.key for one in assumptions(ship(loss_factor=0.01), (VIBRATION,))}
    assert "shaft.propeller.loss_factor" not in given
    (_, table) = shaft_section(ship(loss_factor=0.01)).tables
    damping = {str(row["what"]): row["value"] for row in table[1].rows}
    assert damping["loss factor of the shaft between propeller and its neighbour"] == "0.01"
    assert damping["loss factor of the coupling"] == "0.15"
    assert damping["absolute damping of the propeller"] == "2600 N m s/rad"


def test_a_loss_factor_without_a_shaft_is_refused() -> None:
    rigid: dict[str, Any] = {"inertia_kg_m2": 700.0, "loss_factor": 0.01}
    with pytest.raises(CranktopoError, match=r"shaft\.driven\.loss_factor = 0\.01: belongs to .*stiffness"):
        medium_speed(shaft={**SHAFT, "driven": rigid})


def test_the_loss_of_a_line_alone_is_damping() -> None:
    driven = {"inertia_kg_m2": 700.0, "stiffness_Nm_per_rad": 3.9e6, "loss_factor": 0.01}
    shaft = medium_speed(shaft={"throw_loss_factor": 0.0, "driven": driven}).shaft
    assert shaft is not None
    assert is_damped(shaft)
