"""More torque may leave a fillet as safe as before: what counts is the torque where bending is at an extreme.

A fast twin whose pulley and flywheel raise the range of the torque behind its throw by a quarter. Its stress
over the cycle is summed up by hand, judged by hand, and told by statics beside the web.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.tasks.fatigue.lsa import lsa_strength, point_strength_MPa
from cranktopo.tasks.shaft.web_sections import WebSections, web_sections
from cranktopo.tasks.throw_fatigue.least import least_safeties, web_parts
from cranktopo.tasks.throw_fatigue.shaft_stress import (
    ShaftStress,
    factors_of,
    solve_shaft_stress,
    solved_cycle,
)
from cranktopo.tasks.throw_fea.targets import Target
from tests.fast_twin import LOSS, PULLEY_NM, THROW_NM, fast_twin
from tests.physics.engine.twin_by_hand import TwinByHand

pytestmark = pytest.mark.slow
SHAFT = {
    "speed_min_rpm": 4000.0,
    "speed_max_rpm": 12000.0,
    "throw_stiffness_Nm_per_rad": THROW_NM,
    "throw_loss_factor": LOSS,
    "flywheel": {"inertia_kg_m2": 0.02},
    "pulley": {"inertia_kg_m2": 0.0005, "stiffness_Nm_per_rad": PULLEY_NM, "loss_factor": LOSS},
}
COARSE_FILLET = 2.0


def twin(vibration: str) -> Scene:
    return fast_twin(shaft=SHAFT, effects={"torsional_vibration": vibration})


@dataclass(frozen=True)
class Judged:
    """The journal fillet of the web at the flywheel, by hand at its least safe node.

    Attributes:
        told: least safety by the product, and `safety` by hand.
        stress_MPa: at that node, (states, 6).
        extremes: states of the highest and the lowest signed von Mises stress.
    """

    sections: WebSections
    told: float
    safety: float
    node: int
    stress_MPa: Array
    extremes: tuple[int, int]

    @property
    def torque_Nm(self) -> Array:
        """Torque in the journal at the flywheel, in the sense of rotation."""
        return self.sections.journal_torque_Nm[0, 1]

    @property
    def beside(self) -> Array:
        """One, and all forces and moments in the middle of the web, (states, 6)."""
        s = self.sections
        acting = (s.journal_torque_Nm, s.bending_Nm, s.side_bending_Nm, s.shear_N, s.side_shear_N)
        return np.column_stack([np.ones(len(s.angle_deg)), *(curve[0, 1] for curve in acting)])


def von_mises_MPa(stress: Array) -> Array:
    x, y, z, xy, yz, zx = np.moveaxis(stress, -1, 0)
    return np.sqrt(((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) / 2 + 3 * (xy**2 + yz**2 + zx**2))


def by_hand(stress: ShaftStress, scene: Scene, node: int, image: int, loads: Array) -> tuple[float, Array]:
    """Return the safety of a node and its signed stress over the cycle, every state from its tensor."""
    model, depth_mm = stress.model, 1e-5
    factors = loads * model.images[image].signs
    tensor, below = (
        factors @ part[:, node] for part in (model.stress.stress_MPa, model.stress.depth_MPa_per_mm)
    )
    size = von_mises_MPa(tensor)
    signed = np.where(tensor[:, :3].sum(axis=1) >= 0, size, -size)
    worst = np.abs(signed).argmax()
    fall = (size[worst] - von_mises_MPa(tensor[worst] + depth_mm * below[worst])) / depth_mm
    strength = lsa_strength(scene)
    limit = point_strength_MPa(np.array([max(fall / size[worst], 0.0)]), strength)[0][0]
    amplitude, mean = np.ptp(signed) / 2, (signed.max() + signed.min()) / 2
    return 1 / (amplitude / limit + max(mean, 0.0) / strength.ultimate_MPa), signed


def judged(stress: ShaftStress, scene: Scene) -> Judged:
    solved = solved_cycle([stress], scene, scene, None)
    _, forces, cycle = solved
    loads = factors_of([stress], scene, solved)[1][0]
    part = next(p for p in web_parts(stress.model) if p.side == 1 and p.part == "journal_fillet")
    places = [(node, image) for image in part.images for node in np.flatnonzero(part.nodes)]
    safety, (node, image) = min((by_hand(stress, scene, *at, loads)[0], at) for at in places)
    signed = by_hand(stress, scene, node, image, loads)[1]
    model = stress.model
    return Judged(
        web_sections(cycle, [scene], forces.swing),
        float(least_safeties(model, [loads[None]], "lsa")[0][1, "journal_fillet"][0]),
        safety,
        int(node),
        loads * model.images[image].signs @ model.stress.stress_MPa[:, node],
        (int(signed.argmax()), int(signed.argmin())),
    )


@pytest.fixture(scope="module")
def both() -> tuple[Judged, Judged]:
    """Without vibration and with it."""
    stress = solve_shaft_stress(Target("twin", twin("on")), COARSE_FILLET)
    still, vibrating = (judged(stress, twin(vibration)) for vibration in ("off", "on"))
    return still, vibrating


def test_the_safety_is_that_of_the_stress_summed_up_by_hand(both: tuple[Judged, Judged]) -> None:
    for one in both:
        assert one.told == pytest.approx(one.safety, rel=1e-4)


def test_the_journal_has_the_torque_of_the_chain_at_every_angle(both: tuple[Judged, Judged]) -> None:
    """But for what the mesh has of the pin's arm."""
    torque = both[1].torque_Nm
    expected = TwinByHand.of(twin("on")).torques_Nm(11500.0)[1][::2]
    assert torque == pytest.approx(expected, abs=0.01 * np.ptp(expected))


def test_the_stress_is_what_statics_beside_the_web_make_of_it(both: tuple[Judged, Judged]) -> None:
    """Each force and moment by its share in a still shaft: vibration adds no stress but by these.

    What the mass of the web takes up between journal and middle is what is left.
    """
    still, vibrating = both
    assert still.node == vibrating.node
    shares, *_ = np.linalg.lstsq(still.beside, still.stress_MPa, rcond=None)
    scale = np.ptp(vibrating.stress_MPa, axis=0).max()
    assert still.beside @ shares == pytest.approx(still.stress_MPa, abs=1e-3 * scale)
    assert vibrating.beside @ shares == pytest.approx(vibrating.stress_MPa, abs=0.02 * scale)


def test_more_torque_is_no_lower_safety_where_bending_meets_less_of_it(both: tuple[Judged, Judged]) -> None:
    still, vibrating = both
    assert np.ptp(vibrating.torque_Nm) > 1.2 * np.ptp(still.torque_Nm)
    assert vibrating.told > 1.02 * still.told
    low = still.extremes[1]
    assert abs(vibrating.extremes[1] - low) < 5, "degrees: bending, which is the same, decides"
    assert vibrating.torque_Nm[low] < 0.5 * still.torque_Nm[low]
    moved = vibrating.beside.copy()
    moved[:, 1] = still.beside[:, 1]
    shares, *_ = np.linalg.lstsq(still.beside, still.stress_MPa, rcond=None)
    with_its_torque = von_mises_MPa(moved @ shares)[low]
    assert with_its_torque == pytest.approx(von_mises_MPa(still.stress_MPa)[low], rel=0.03)
