"""Every web that an envelope holds, as densities of cells from 0 to 1, and a goal as a bound takes it.

No filter, no penalty: whatever an optimiser or a parametric web puts into the cells is among them. Where a
die shapes the web, the density never grows outward from its parting plane; draft is left out, which only adds
webs.

A stiffness is a load squared over a compliance. A limit that no convex statement can hold is left out, which
only adds webs: the bound stays one, but a looser one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode, invalid
from cranktopo.bodies.cells.domain import Domain
from cranktopo.design.goal.constraint import Constraint
from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.goal.quantities import QUANTITIES, STIFFNESS_OF, QuantityName
from cranktopo.design.schema import Scene
from cranktopo.numerics.filters.processes import Parting
from cranktopo.tasks.density.manufacturing import designable, is_manufactured, parting_of, pull_axis
from cranktopo.tasks.density.model import ThrowModel
from cranktopo.tasks.density.responses import Design, Response, quantities_of

LINEAR = ("mass", "inertia", "unbalance")
STIFFNESSES: tuple[QuantityName, ...] = ("torsion", "bending")


@dataclass(frozen=True)
class ConvexProblem:
    """Objective and constraints, every quantity over its value for the original web.

    Attributes:
        quantity: what is minimised: a compliance, by its load case, or a sum over cells.
        per_mass: minimise its product with the mass.
        constraints: on compliances, by their load cases, and on sums over cells.
        limits: the constraints as the user knows them.
        dropped: limits that are left out, each with the reason.
    """

    goal: Goal
    quantity: str
    per_mass: bool
    constraints: tuple[Constraint, ...]
    limits: tuple[Limit, ...]
    dropped: tuple[tuple[Limit, str], ...]

    def goal_value(self, value: float, original: float) -> float:
        """Return the goal's own quantity for a value of what is minimised, by that of the original."""
        return original / value if self.goal.sense == "maximise" else original * value


def convex_problem(goal: Goal, original: Mapping[str, float]) -> ConvexProblem:
    """Return a goal as a bound takes it, by quantities of the original web in the same model.

    Raises:
        CranktopoError: a goal about which nothing can be proven.
    """
    if why := QUANTITIES[goal.quantity].unproven:
        raise invalid(
            f"goal.{goal.sense}",
            goal.quantity,
            f"a bound is proven for mass, inertia, unbalance and stiffness; {why}",
            "Name another goal; limits of other quantities are left out, which keeps the bound valid.",
        )
    if goal.quantity == "unbalance" and original["unbalance"] <= 0:
        raise CranktopoError(
            f"goal: the original's unbalance is {original['unbalance']:.4g} kg mm, not above 0, and a "
            "bound is told by its share.",
            hint="Minimise the mass or the inertia.",
            code=ExitCode.INVALID_INPUT,
        )
    found = [(limit, _constraint(limit, original)) for limit in goal.limits]
    kept = [(limit, one) for limit, one in found if isinstance(one, Constraint)]
    dropped = tuple((limit, why) for limit, why in found if isinstance(why, str))
    name = goal.quantity.removesuffix("_per_mass")
    constraints, limits = tuple(one for _, one in kept), tuple(limit for limit, _ in kept)
    return ConvexProblem(goal, name, name != goal.quantity, constraints, limits, dropped)


def _constraint(limit: Limit, original: Mapping[str, float]) -> Constraint | str:
    """Return the limit over the original's value, or why no convex statement holds it."""
    if why := QUANTITIES[limit.quantity].unproven:
        return why
    own = original[limit.quantity]
    if own == 0:
        return "the original's value is 0"
    share = limit.value / 100 if limit.percent else limit.value / own
    if limit.quantity in LINEAR:
        return Constraint(limit.quantity, "<=" if (limit.sense == "<=") == (own > 0) else ">=", share)
    if limit.quantity.endswith("_per_mass"):
        return "a least stiffness per mass is not convex"
    if limit.quantity in STIFFNESS_OF and limit.sense == "<=":
        return Constraint(STIFFNESS_OF[limit.quantity], "<=", share)
    if limit.quantity in STIFFNESSES and limit.sense == ">=":
        return Constraint(limit.quantity, "<=", 1 / share)
    return "a web may not be too stiff: that is not convex"


def limit_on_cells(limit: Limit, cells: Mapping[str, float], judged: Mapping[str, float]) -> Limit:
    """Return a limit that another model judges as the cells have it; one in percent holds in either.

    Sums over cells err by what they leave out of journals and fillets, which every web has alike: the limit
    moves by the difference of the original's. A stiffness errs by a factor.

    Args:
        cells, judged: quantities of the original web in the cells and in the other model.
    """
    name = limit.quantity
    if limit.percent or not {name} <= cells.keys() & judged.keys():
        return limit
    if name in LINEAR:
        return replace(limit, value=limit.value + cells[name] - judged[name])
    return replace(limit, value=limit.value * cells[name] / judged[name]) if judged[name] else limit


_TINY = 1e-300


class _DieSplit(NamedTuple):
    """Axis along which the halves of a die leave, and where they part."""

    axis: int
    parting: Parting


@dataclass(frozen=True)
class AdmissibleDensities:
    """The webs of an envelope.

    Attributes:
        fixed: solid fraction that every web has (nx, ny, nz).
        design: fraction that a web may fill (nx, ny, nw).
        layers: z layers of the web.
        amounts: what a full cell adds to mass, inertia and unbalance of the throw, each (nx, ny, nw).
        fixed_amounts: what the fixed material has of them.
        die: None where any density may be made.
    """

    fixed: Array
    design: Array
    layers: slice
    amounts: Mapping[str, Array]
    fixed_amounts: Mapping[str, float]
    die: _DieSplit | None = None

    def best(self, gains: Array) -> tuple[float, Array]:
        """Return the largest sum of gains times densities, and densities that reach it (nx, ny, nw)."""
        if self.die is None:
            taken = gains > 0
            return float(np.sum(np.where(taken, gains, 0.0))), taken.astype(np.float64)
        axis, (end, start) = self.die
        moved = np.moveaxis(gains, axis, 0)
        # The layers that one half forms alone, from the parting plane outward, and one that both share.
        left, right = moved[:start][::-1], moved[end:]
        shared = moved[start:end].sum(axis=0)
        (from_left, keep_left), (from_right, keep_right) = _best_chain(left), _best_chain(right)
        middle = shared + from_left + from_right
        roots = np.maximum(middle, 0.0) if end > start else middle
        open_ = middle > 0 if end > start else np.ones(middle.shape, bool)
        parts = (
            keep_left[::-1] & open_,
            np.broadcast_to(open_, (end - start, *open_.shape)),
            keep_right & open_,
        )
        chosen = np.concatenate(parts).astype(np.float64)
        return float(np.sum(roots)), np.moveaxis(chosen, 0, axis)

    def makeable(self, density: Array, above: Array, below: Array) -> Array:
        """Return densities that a die can make, with the least above / density + below * density.

        Without a die they are those of each cell on its own, `density`.
        """
        if self.die is None:
            return density
        axis, (end, start) = self.die
        above, below = np.moveaxis(above, axis, 0), np.moveaxis(np.maximum(below, _TINY), axis, 0)
        left = _falling(above[:end][::-1], below[:end][::-1])[::-1]
        right = _falling(above[end:], below[end:])
        if end > start:
            right = np.minimum(right, left[-1])
        return np.moveaxis(np.sqrt(np.concatenate([left, right])), 0, axis)


def _falling(above: Array, below: Array) -> Array:
    """Return means of above / below that never grow along the first axis and lie nearest to each of them.

    Source: R. E. Barlow et al., Statistical Inference under Order Restrictions, 1972, min-max formula.
    """
    found = np.full(above.shape, np.inf)
    for first in range(len(above)):
        means = np.cumsum(above[first:], axis=0) / np.cumsum(below[first:], axis=0)
        largest = np.maximum.accumulate(means[::-1], axis=0)[::-1]
        found[first:] = np.minimum(found[first:], largest)
    return found


def _best_chain(gains: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return the largest sums over first parts of columns along the first axis, >= 0, and what they take."""
    ahead, paying = np.zeros(gains.shape[1:]), np.zeros(gains.shape, bool)
    for layer in range(len(gains) - 1, -1, -1):
        ahead = np.maximum(gains[layer] + ahead, 0.0)
        paying[layer] = ahead > 0
    return ahead, np.logical_and.accumulate(paying, axis=0)


def webs_of(scene: Scene, domain: Domain, model: ThrowModel) -> AdmissibleDensities:
    """Return the webs of a scene's envelope, as it is simulated; call inside `double_precision()`."""
    layers = slice(*domain.web_layers)
    design = np.asarray(designable(scene, domain))
    known = quantities_of(scene, model)
    sums = {name: known[name] for name in LINEAR}
    values, slopes = _values_and_slopes(tuple(sums.values()), domain.passive_fraction)
    return AdmissibleDensities(
        fixed=domain.passive_fraction,
        design=design,
        layers=layers,
        amounts={name: by[:, :, layers] * design for name, by in zip(sums, slopes, strict=True)},
        fixed_amounts=dict(zip(sums, values.tolist(), strict=True)),
        die=_die(scene, domain),
    )


def _values_and_slopes(sums: tuple[Response, ...], solid: Array) -> tuple[Array, Array]:
    """Return sums over the cells (k,) and their derivatives (k, nx, ny, nz) by the solid fraction."""

    def values(solid: jax.Array) -> jax.Array:
        none = jnp.zeros(0)
        return jnp.stack([of.value(Design(solid, solid, none, none, none)) for of in sums])

    found = jax.jit(lambda solid: (values(solid), jax.jacrev(values)(solid)))(solid)
    return np.asarray(found[0]), np.asarray(found[1])


def _die(scene: Scene, domain: Domain) -> _DieSplit | None:
    if not is_manufactured(scene) or scene.optimise.process in ("cast", "milled"):
        return None
    axis = pull_axis(scene)
    return _DieSplit(axis, parting_of(domain, axis))
