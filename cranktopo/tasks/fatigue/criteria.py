"""Registry of the methods of `fatigue --method`: one line each."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cranktopo.tasks.fatigue.criterion import FatigueCriterion, SafetyMethod

METHODS = {
    "lsa": "cranktopo.tasks.fatigue.lsa:LSA",
    "fkm": "cranktopo.tasks.fatigue.fkm:FKM",
    "m53": "cranktopo.tasks.fatigue.m53:M53",
}
"""Name on the command line: the method as "module:constant", loaded when it is taken."""


def safety_method(name: str) -> SafetyMethod:
    """Load a method of the registry."""
    module, _, constant = METHODS[name].partition(":")
    found: SafetyMethod = getattr(import_module(module), constant)
    return found


def criterion(name: str) -> FatigueCriterion:
    """Load a method of the registry that is a criterion of local stresses."""
    from cranktopo.tasks.fatigue.criterion import FatigueCriterion

    found = safety_method(name)
    assert isinstance(found, FatigueCriterion)
    return found
