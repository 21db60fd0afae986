"""Consistency of every bolt: head over hole over thread, parts about it, shank in the grip, engaged turns."""

from __future__ import annotations

from collections.abc import Iterator

from cranktopo.base.errors import invalid
from cranktopo.design.bolt import LOST_TURNS, Bolt, BoltedJoint, least_member_mm
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene


def check_bolt_dimensions(scene: Scene) -> None:
    """Check that every bolt of a design can be."""
    for number, joint in enumerate(scene.bolted_joint):
        _check_force(scene, f"bolted_joint[{number}]", joint)
    for path, bolt in bolts_of(scene):
        diameter = bolt.nominal.diameter_mm
        least = (
            ("hole_diameter_mm", bolt.hole_diameter_mm, diameter),
            ("member_diameter_mm", bolt.member_diameter_mm, least_member_mm(bolt)),
            ("grip_mm", bolt.grip_mm, bolt.shank_mm),
            ("engagement_mm", bolt.engagement_mm, (LOST_TURNS + 1) * bolt.nominal.pitch_mm),
        )
        for key, value, smallest in least:
            if value is not None and value < smallest:
                raise scene.invalid(
                    f"{path}.{key}", f"must be at least {smallest:.4g} mm beside the bolt's other dimensions"
                )
        if bolt.head_mm < 1.05 * bolt.hole_mm:
            key = "hole_diameter_mm" if bolt.head_diameter_mm is None else "head_diameter_mm"
            sizes = f"a head of {bolt.head_mm:.4g} mm over a hole of {bolt.hole_mm:.4g} mm"
            raise scene.invalid(f"{path}.{key}", f"must give the head a bearing face: {sizes} has none")
        if bolt.shank_diameter_mm is not None and not 0.5 < bolt.shank_diameter_mm / diameter < 1.5:
            raise scene.invalid(
                f"{path}.shank_diameter_mm", f"must be near the {diameter:g} mm of the thread"
            )


def _check_force(scene: Scene, path: str, joint: BoltedJoint) -> None:
    """Check that the force on one bolt is given once, and that it is the larger one."""
    if joint.holds is not None:
        _check_held(scene, path, joint)
    elif joint.max_force_N is None:
        raise invalid(f"{path}.max_force_N", None, "is missing", "Give it, or `holds` what the bolts hold.")
    elif joint.min_force_N > joint.max_force_N:
        raise scene.invalid(f"{path}.min_force_N", f"must be at most max_force_N, {joint.max_force_N:g} N")


def _check_held(scene: Scene, path: str, joint: BoltedJoint) -> None:
    if joint.max_force_N is not None or joint.min_force_N:
        key = "max_force_N" if joint.max_force_N is not None else "min_force_N"
        raise scene.invalid(f"{path}.{key}", "has no meaning beside `holds`, whose force it is")
    if scene.engine is None:
        raise scene.invalid(f"{path}.holds", "needs [engine], at whose highest speed it pulls")
    if not any(half.web.counterweight and half.web.counterweight.bolted for half in halves(scene)):
        allowed = (
            "names a counterweight of its own density (web.counterweight.density_kg_m3), and there is none"
        )
        raise scene.invalid(f"{path}.holds", allowed)


def bolts_of(scene: Scene) -> Iterator[tuple[str, Bolt]]:
    """Yield every bolt of a design with the path of its table."""
    for number, joint in enumerate(scene.bolted_joint):
        yield f"bolted_joint[{number}]", joint
    if scene.rod is not None and scene.rod.bolt is not None:
        yield "rod.bolt", scene.rod.bolt
    for number, weight in enumerate(scene.balancer.weight if scene.balancer else ()):
        if weight.bolt is not None:
            yield f"balancer.weight[{number}].bolt", weight.bolt
