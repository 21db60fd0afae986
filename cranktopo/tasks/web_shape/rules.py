"""Every rule of a web by name, with gradients: manufacturing rules, and that it stays inside the envelope."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.spans import holds
from cranktopo.bodies.envelope_file import envelope_bounds_mm, envelope_section, envelope_sections
from cranktopo.design.clearance import clearance_limit
from cranktopo.design.free_dimensions import is_of_counterweight
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import central_difference
from cranktopo.tasks.refit.family import Layout, scene_at
from cranktopo.tasks.refit.parametric_web import NO_LENGTHS, ParametricWeb
from cranktopo.throw.envelope import Envelope
from cranktopo.throw.fitted import CLEAR_MM

_RIM = 25
"""Points of a counterweight's arc, and of its fillet's."""
_STEP = 1e-6
_SAMPLES = 400
"""Samples of an envelope's section along its longer side, where it has no closed form."""


class EnvelopeClearance:
    """Distances of points of the outline's right half from the envelope, mm; 0 or less inside."""

    def __init__(self, scene: Scene) -> None:
        self._limit = clearance_limit(scene)
        self._scene, self._envelope, self._web_z_mm = scene, scene.envelope, scene.web_z_mm

    def constraints(self, web: ParametricWeb, values: Array) -> tuple[Array, Array]:
        """Return excesses of outline, free counterweight and fillets, kept where <= 0, and their gradients.

        Without an envelope there are none.
        """
        if self._envelope is None:
            return np.zeros(0), np.zeros((0, len(values)))
        bodies = [web.points(values)]
        if any(is_of_counterweight(name) for name in web.layout.dimensions):
            bodies.append(self._rim(web.layout, values))
        fillet = web.fillet(values)
        if fillet is not None:
            arc = np.stack(fillet.circle.arc_mm(_RIM), axis=1)
            bodies.append((arc, np.broadcast_to(fillet.gradients, (_RIM, *fillet.gradients.shape))))
        found = [self._of_points(self._envelope, *body, len(values)) for body in bodies]
        outside, gradients = zip(*found, strict=True)
        return np.concatenate(outside), np.vstack(gradients)

    def _rim(self, layout: Layout, values: Array) -> tuple[Array, Array]:
        """Return points of the counterweight's arc, (n, 2), mm, and their derivatives, (n, 2, parameters)."""

        def points(values: Array) -> Array:
            weight = scene_at(self._scene, layout, values).web.counterweight
            assert weight is not None
            return np.stack(weight.sector(self._scene).rim_mm(_RIM), axis=1)

        places = [layout.names.index(name) for name in layout.dimensions if is_of_counterweight(name)]
        return points(values), central_difference(points, values, _STEP, places)

    def _of_points(
        self, envelope: Envelope, points: Array, by_values: Array, count: int
    ) -> tuple[Array, Array]:
        """Return the excess of points whose derivatives are by the first of `count` parameters."""
        outside, by_points = self._outside(envelope, points)
        if self._limit is not None:
            x, y = points.T
            outside = np.vstack([outside, self._limit.outside_mm(x, y)])
            by_points = np.concatenate([by_points, self._limit.gradients(x, y)[None]])
        gradients = np.zeros((outside.size, count))
        by_own = np.einsum("cnk,nkp->cnp", by_points, by_values)
        gradients[:, : by_values.shape[2]] = by_own.reshape(outside.size, -1)
        return outside.ravel() + CLEAR_MM, gradients

    def _outside(self, envelope: Envelope, points: Array) -> tuple[Array, Array]:
        """Return excesses (constraints, n) and their derivatives by each point (constraints, n, 2)."""
        known = envelope.outside_mm(points)
        return _interpolated(*self._field, points) if known is None else known

    @cached_property
    def _field(self) -> tuple[Array, Array, Array]:
        """Signed distance from the common part of all sections on a lattice x >= 0, positive outside, mm."""
        from scipy.ndimage import distance_transform_edt

        assert self._envelope is not None
        _, wide, low, high = envelope_bounds_mm(self._envelope)
        step = max(wide, high - low) / _SAMPLES
        x, y = np.arange(-4, wide / step + 5) * step, np.arange(low - 4 * step, high + 5 * step, step)
        sections, (start, end) = envelope_sections(self._envelope), self._web_z_mm
        heights = start + (end - start) * (np.arange(sections) + 0.5) / sections
        inside = np.ones((x.size, y.size), dtype=bool)
        for z in heights:
            spans = envelope_section(self._envelope, float(z))(y, np.full_like(y, z))
            inside &= holds(spans, np.abs(x)[:, None])
        outer, inner = distance_transform_edt(~inside), distance_transform_edt(inside)
        return x, y, np.asarray(step * (outer - inner))


def _interpolated(x: Array, y: Array, field: Array, points: Array) -> tuple[Array, Array]:
    """Return bilinear values at points, (1, n), and derivatives (1, n, 2); straight beyond the lattice."""
    step = x[1] - x[0]
    i = np.clip(((points[:, 0] - x[0]) / step).astype(int), 0, x.size - 2)
    j = np.clip(((points[:, 1] - y[0]) / step).astype(int), 0, y.size - 2)
    u, v = (points[:, 0] - x[i]) / step, (points[:, 1] - y[j]) / step
    a, b, c, d = field[i, j], field[i + 1, j], field[i, j + 1], field[i + 1, j + 1]
    value = a * (1 - u) * (1 - v) + b * u * (1 - v) + c * (1 - u) * v + d * u * v
    by_x, by_y = ((b - a) * (1 - v) + (d - c) * v) / step, ((c - a) * (1 - u) + (d - b) * u) / step
    return value[None], np.stack([by_x, by_y], axis=-1)[None]


ENVELOPE = "room of the envelope"
_BROKEN_MM = 0.05


@dataclass(frozen=True)
class Rules:
    """Every manufacturing rule of a web and the room of the envelope.

    Attributes:
        excess: (rules,) kept where <= 0, mm.
        gradients: (rules, parameters).
    """

    names: tuple[str, ...]
    excess: Array
    gradients: Array

    @property
    def violated(self) -> tuple[str, ...]:
        """Names of the rules that the web does not keep."""
        return tuple(self.violations_mm)

    @property
    def violations_mm(self) -> dict[str, float]:
        """By how much it breaks them at most, by name; mm but for those of `NO_LENGTHS`."""
        found: dict[str, float] = {}
        for name, over in zip(self.names, self.excess.tolist(), strict=True):
            if over > _BROKEN_MM:
                found[name] = max(over, found.get(name, 0.0))
        return found

    @property
    def violation_text(self) -> str:
        """Names of the rules that it breaks and by how much, the worst first."""
        worst = sorted(self.violations_mm.items(), key=lambda item: (-round(item[1], 3), item[0]))
        return ", ".join(f"'{name}' is broken by {_amount(name, over)}" for name, over in worst)


def rule_unit(name: str) -> str:
    """Return the unit of a rule's excess: mm, but a share of the least radius, and of the outline's rise."""
    return "%" if name.startswith(NO_LENGTHS) else "mm"


def _amount(name: str, over: float) -> str:
    return f"{over:.2f} mm" if rule_unit(name) == "mm" else f"{100 * over:.0f} %"


def rules_at(scene: Scene, web: ParametricWeb, values: Array) -> Rules:
    """Return the rules of a web with these values."""
    excess, gradients = rules_of(web, EnvelopeClearance(scene), values)
    names = web.rule_names(values)
    return Rules((*names, *[ENVELOPE] * (len(excess) - len(names))), excess, gradients)


def rules_of(web: ParametricWeb, clearance: EnvelopeClearance, values: Array) -> tuple[Array, Array]:
    """Return manufacturing constraints and envelope, mm, kept where <= 0, and their gradients."""
    inside, gradients = clearance.constraints(web, values)
    return np.concatenate([web.constraints(values), inside]), np.vstack([web.gradients(values), gradients])
