"""Registry of the methods of `fatigue --method`: one line each."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module
from typing import TYPE_CHECKING

from cranktopo.base.errors import CranktopoError, ExitCode

if TYPE_CHECKING:
    from cranktopo.design.schema import Scene
    from cranktopo.tasks.fatigue.criterion import FatigueCriterion, SafetyMethod

LOCAL_METHODS = {
    "lsa": "cranktopo.tasks.fatigue.lsa:LSA",
    "fkm": "cranktopo.tasks.fatigue.fkm:FKM",
}
"""Methods that judge amplitude, mean and gradient of a local stress; `shaft --method` takes these alone."""
PLANE_METHODS = {
    "findley": "cranktopo.tasks.fatigue.findley:FINDLEY",
    "dang_van": "cranktopo.tasks.fatigue.dang_van:DANG_VAN",
}
"""Methods that judge the stress tensors of all load states."""
METHODS = {**LOCAL_METHODS, "m53": "cranktopo.tasks.throw_fatigue.m53:M53", **PLANE_METHODS}
"""Name on the command line: the method as "module:constant", loaded when it is taken."""


def safety_method(name: str) -> SafetyMethod:
    """Load a method of the registry."""
    module, _, constant = METHODS[name].partition(":")
    found: SafetyMethod = getattr(import_module(module), constant)
    return found


def shortfall_words(method: str, safety: float) -> str:
    """Return what a safety lacks by a method: below 1 it fails, below what that asks for it is not enough.

    Empty where it lacks nothing. Every command that says so takes these words.
    """
    asked = safety_method(method)
    if safety < 1:
        return "is below 1: by this method it fails"
    if safety < asked.asks:
        return (
            f"is below {asked.asks:g}, the least that {asked.title} asks for: by this method it is not enough"
        )
    return ""


def strengths_of(methods: Iterable[str]) -> set[str]:
    """Return the keys of the material that some methods rest on.

    Those of local stresses say where it yields; the rule has no such place.
    """
    taken = set(methods)
    needed = {key for name in taken for key in safety_method(name).needs}
    return needed | ({"yield_MPa"} if taken - {"m53"} else set())


def criterion(name: str) -> FatigueCriterion:
    """Load a method of the registry that is a criterion of local stresses.

    Raises:
        CranktopoError: it is of another kind.
    """
    from cranktopo.tasks.fatigue.criterion import FatigueCriterion

    found = safety_method(name)
    if not isinstance(found, FatigueCriterion):
        raise CranktopoError(
            f"method '{name}' does not judge amplitude and mean of a local stress, which is needed here.",
            hint=f"Take {' or '.join(LOCAL_METHODS)}.",
            code=ExitCode.USAGE,
        )
    return found


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
