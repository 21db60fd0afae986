"""Needs of an assessment: strengths and packages of the method, round fillets, effects and loads."""

from __future__ import annotations

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import Loads, WebLoads
from cranktopo.engine.judged_histories import counts_swing, counts_tangential, histories_of
from cranktopo.engine.plan.planning import plan_for_stress, stress_left_off
from cranktopo.tasks.fatigue.criteria import check_method
from cranktopo.tasks.shaft.stage import shaft_left_off
from cranktopo.tasks.throw_fatigue.stress_mesh import check_fillets
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.throw_fea.unit_fields import FieldKind

_EVERY: tuple[FieldKind, ...] = ("bending", "tangential", "torsion", "centrifugal")
_IN_SHAFT: tuple[FieldKind, ...] = ("moment", "side_moment", *_EVERY)


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

    The tangential force acts in the cycle alone: it counts where that is known. A web in its shaft has every
    load, and moments of its neighbours. Where the shaft vibrates, the throw's own mass counts there too.
    """
    if isinstance(kind, WebLoads):
        every: frozenset[str] = frozenset(_EVERY)
        return every, _IN_SHAFT + _swing(scene, kind, every)
    enabled = plan_for_stress(scene).enabled
    left_out = set() if counts_tangential(scene, kind, enabled) else {"tangential"}
    return enabled, tuple(k for k in _EVERY if k in enabled - left_out) + _swing(scene, kind, enabled)


def _swing(scene: Scene, kind: Loads, enabled: frozenset[str]) -> tuple[FieldKind, ...]:
    return ("swing",) if counts_swing(scene, kind, enabled) else ()


def safety_left_off(scene: Scene) -> str:
    """Name the loads that a safety leaves out although they are above the threshold; empty where none is."""
    return shaft_left_off(scene) if scene.effects.continuous_shaft == "on" else alone_left_off(scene)


def alone_left_off(scene: Scene) -> str:
    """Name the same of a throw that stands alone."""
    return "; ".join(filter(None, (stress_left_off(scene), _without_cycle(scene))))


def _without_cycle(scene: Scene) -> str:
    """Name a tangential force that the plan has on and no cycle tells; empty else."""
    enabled = plan_for_stress(scene).enabled
    if "tangential" not in enabled or counts_tangential(scene, "extremes", enabled):
        return ""
    return "left out although the plan has it on: tangential (its cycle needs [engine.gas])"
