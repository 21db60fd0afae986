"""Needs of an assessment: strengths and packages of the method, round fillets, effects and loads."""

from __future__ import annotations

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import note
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import Loads, WebLoads, histories_of
from cranktopo.engine.plan.planning import plan_for_stress
from cranktopo.tasks.fatigue.criteria import safety_method
from cranktopo.tasks.fatigue.stress_model import check_fillets
from cranktopo.tasks.fea.targets import Target
from cranktopo.tasks.fea.unit_fields import FieldKind

_EVERY: tuple[FieldKind, ...] = ("bending", "tangential", "torsion", "centrifugal")
_IN_SHAFT: tuple[FieldKind, ...] = ("moment", "side_moment", *_EVERY)


def check_method(scene: Scene, method: str) -> None:
    """Check that material, fillets and packages are what a method needs.

    Raises:
        CranktopoError: a strength or a package is missing, or an elliptical fillet, of which the rule has no
            strength.
    """
    found = safety_method(method)
    found.load_packages()
    for key in found.needs:
        if getattr(scene.material, key) is None:
            raise CranktopoError(
                f"{scene.name}: material.{key}: is missing, method '{method}' needs it "
                f"(material '{scene.material.name}').",
                hint=f"Give material.{key}, or name a material of the library.",
            )
    found.check(scene)


def check_inputs(target: Target, method: str, kind: Loads) -> None:
    """Check everything that a user can get wrong, before the first solve.

    Raises:
        CranktopoError: missing material data or loads, sharp fillets, or for the rule a body from CAD.
    """
    if method == "m53" and target.file is not None:
        raise CranktopoError(
            f"target '{target.name}': method 'm53' needs the width and the outline of the web, which a file "
            "does not name.",
            hint="Take another --method, or give a design.",
            code=ExitCode.USAGE,
        )
    check_method(target.scene, method)
    check_loads(target, kind)


def check_loads(target: Target, kind: Loads) -> None:
    """Check that the fillets and the loads give a stress.

    Raises:
        CranktopoError: missing loads, or sharp fillets.
    """
    check_fillets(target)
    histories_of(target.scene, kind, load_kinds(target.scene, kind)[0])


def load_kinds(scene: Scene, kind: Loads) -> tuple[frozenset[str], tuple[FieldKind, ...]]:
    """Effects that the plan of a scene switches on for stress, and the loads to be solved.

    The extreme states hold radial force and torque; the tangential force acts in the cycle alone. A web in
    its shaft has every load, and moments of its neighbours.
    """
    if isinstance(kind, WebLoads):
        return frozenset(_EVERY), _IN_SHAFT
    enabled = plan_for_stress(scene).enabled
    possible: tuple[FieldKind, ...] = ("bending", "torsion", "centrifugal")
    if kind == "cycle":
        possible = _EVERY
    return enabled, tuple(k for k in possible if k in enabled)


def note_tangential(name: str, scene: Scene, kind: Loads) -> None:
    """Tell that joined extremes leave out a tangential force that the plan has on: some places have less."""
    if kind == "extremes" and "tangential" in plan_for_stress(scene).enabled:
        note(
            f"{name}: joined extremes leave out the tangential force, which the plan has on: with it, places "
            "may have less than is told (--loads cycle)"
        )
