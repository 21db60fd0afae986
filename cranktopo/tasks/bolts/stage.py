"""Every bolted joint of a design, verified."""

from __future__ import annotations

import math

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.volume import counterweight_mass
from cranktopo.design.assumed import Assumption
from cranktopo.design.balancer import BalancerPart
from cranktopo.design.bolt import Bolt, BoltedJoint
from cranktopo.design.halves import halves
from cranktopo.design.material import Material
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.balance.balancer_shafts import weight_force_N
from cranktopo.engine.rod_forces import rod_bolt_force_N
from cranktopo.engine.rod_split import oblique_bolt_force_N
from cranktopo.tasks.bolts.joint import JointLoads, shigley, vdi_2230
from cranktopo.tasks.bolts.result import BoltChecks, JointCheck


def check_bolts(design: DesignLike) -> BoltChecks:
    """Return rod bolt, `[[bolted_joint]]` and bolts of the balancer shaft, by VDI 2230 and by Shigley.

    Raises:
        CranktopoError: the design has none, or a rod bolt without an engine or gas pressure.
    """
    scene = as_scene(design)
    found = [
        check_joint(
            joint.name,
            joint,
            _loads(scene, joint),
            scene.material,
            joint.permitted_pressure_MPa,
        )
        for joint in scene.bolted_joint
    ]
    rod_bolt = check_rod_bolt(scene)
    found = [*([rod_bolt] if rod_bolt else []), *found, *_on_the_balancer_shaft(scene)]
    if not found:
        raise CranktopoError(
            f"{scene.name}: has no bolted joint.",
            hint="Add [[bolted_joint]], one for each kind of bolt, [rod.bolt] or [balancer.weight.bolt].",
        )
    return BoltChecks(design=scene.name, joints=tuple(found), assumed=rod_bolt_assumed(scene))


def check_rod_bolt(scene: Scene) -> JointCheck | None:
    """Return one of the two bolts of the rod under the largest pull of inertia; None without one.

    With an oblique split it is the one that carries more, under its largest force of the cycle.
    """
    bolt = scene.rod.clamping_bolt if scene.rod else None
    if scene.rod is None or bolt is None:
        return None
    oblique = scene.rod.split_angle_deg > 0
    most, least = (oblique_bolt_force_N(scene), 0.0) if oblique else rod_bolt_force_N(scene)
    return check_joint("rod", bolt, JointLoads(most, least), scene.rod.material or scene.material)


def counterweight_pull_N(scene: Scene) -> float:
    """Return the centrifugal force of a bolted counterweight at the highest speed, of two the larger."""
    engine = engine_of(scene)
    speed = max(engine.own_speeds_rpm)
    bolted = [half for half in halves(scene) if half.web.counterweight and half.web.counterweight.bolted]
    masses = [counterweight_mass(half) for half in bolted]
    return max(weight_force_N(math.hypot(mass.first_x, mass.first_y), speed) for mass in masses)


def _loads(scene: Scene, joint: BoltedJoint) -> JointLoads:
    most = joint.max_force_N
    if most is None:
        most = counterweight_pull_N(scene) / joint.bolts
    return JointLoads(most, joint.min_force_N, joint.clamp_force_N)


def weight_joints(part: BalancerPart, material: Material) -> tuple[JointCheck, ...]:
    """Return the bolts of a balancer shaft's masses under their centrifugal force at its highest speed."""
    return tuple(
        check_joint(
            f"weight {number}",
            weight.bolt,
            JointLoads(weight_force_N(weight.unbalance_kg_mm, part.max_speed_rpm) / weight.bolts),
            material,
        )
        for number, weight in enumerate(part.weight, start=1)
        if weight.bolt is not None
    )


def _on_the_balancer_shaft(scene: Scene) -> tuple[JointCheck, ...]:
    part = scene.balancer
    if part is None:
        return ()
    joints = weight_joints(part, part.material or scene.material)
    return tuple(joint.model_copy(update={"name": f"balancer {joint.name}"}) for joint in joints)


def rod_bolt_assumed(scene: Scene) -> tuple[Assumption, ...]:
    """Return the diameter of the parts that the rod's bolt clamps, where the design leaves it to the boss."""
    rod = scene.rod
    if rod is None or rod.bolt is None or rod.bolt == rod.clamping_bolt:
        return ()
    assert rod.clamping_bolt is not None
    member = rod.clamping_bolt.member_diameter_mm
    assert member is not None
    meaning = "the largest cylinder about the bolt that the boss holds at the split"
    return (Assumption("rod.bolt.member_diameter_mm", member, meaning),)


def check_joint(
    name: str, bolt: Bolt, loads: JointLoads, material: Material, permitted_MPa: float | None = None
) -> JointCheck:
    """Return one joint with the smallest of its safeties."""
    vdi = vdi_2230(bolt, loads, material, permitted_MPa)
    safeties = {
        "clamp": vdi.clamp_safety,
        "yield": vdi.yield_safety,
        "fatigue": vdi.fatigue_safety,
        "head pressure": vdi.head_pressure_safety,
        "thread": vdi.thread_safety,
    }
    smallest, governing = min((value, what) for what, value in safeties.items() if value is not None)
    return JointCheck(
        name=name,
        thread=bolt.thread,
        strength_class=bolt.strength_class,
        stress_area_mm2=bolt.nominal.stress_area_mm2,
        max_force_N=loads.max_N,
        min_force_N=loads.min_N,
        vdi_2230=vdi,
        shigley=shigley(bolt, loads, material),
        smallest_safety=smallest,
        governing=governing,
    )
