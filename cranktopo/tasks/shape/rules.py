"""Every rule of a web by name: manufacturing rules and the room of the envelope, with gradients."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.constraints import NO_LENGTHS
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.shape.envelope_clearance import EnvelopeClearance

ENVELOPE = "room of the envelope"
_BROKEN_MM = 0.05


@dataclass(frozen=True)
class Rules:
    """Every manufacturing rule of a web and the room of the envelope.

    Attributes:
        excess: (rules,) kept where <= 0, mm.
        slopes: (rules, parameters).
    """

    names: tuple[str, ...]
    excess: Array
    slopes: Array

    @property
    def broken(self) -> tuple[str, ...]:
        """Names of the rules that the web does not keep."""
        return tuple(self.broken_mm)

    @property
    def broken_mm(self) -> dict[str, float]:
        """By how much it breaks them at most, by name; mm but for those of `NO_LENGTHS`."""
        found: dict[str, float] = {}
        for name, over in zip(self.names, self.excess.tolist(), strict=True):
            if over > _BROKEN_MM:
                found[name] = max(over, found.get(name, 0.0))
        return found

    @property
    def broken_text(self) -> str:
        """What it breaks and by how much, the worst first."""
        worst = sorted(self.broken_mm.items(), key=lambda item: (-round(item[1], 3), item[0]))
        return ", ".join(f"'{name}' is broken by {_amount(name, over)}" for name, over in worst)


def rule_unit(name: str) -> str:
    """Unit of a rule's excess: mm, but a share of the least radius, and of the outline's rise."""
    return "%" if name.startswith(NO_LENGTHS) else "mm"


def _amount(name: str, over: float) -> str:
    return f"{over:.2f} mm" if rule_unit(name) == "mm" else f"{100 * over:.0f} %"


def rules_at(scene: Scene, web: ParametricWeb, values: Array) -> Rules:
    """The rules of a web with these values."""
    excess, slopes = rules_of(web, EnvelopeClearance(scene), values)
    names = web.rule_names(values)
    return Rules((*names, *[ENVELOPE] * (len(excess) - len(names))), excess, slopes)


def rules_of(web: ParametricWeb, room: EnvelopeClearance, values: Array) -> tuple[Array, Array]:
    """Manufacturing constraints and envelope, mm, kept where <= 0, and their gradients."""
    inside, slopes = room.constraints(web, values)
    return np.concatenate([web.constraints(values), inside]), np.vstack([web.slopes(values), slopes])
