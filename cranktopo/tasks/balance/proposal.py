"""The counterweight of a throw that balances a wanted share of the oscillating mass."""

from __future__ import annotations

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.base.result import Result
from cranktopo.design.balance_factor import rods_kg_mm
from cranktopo.design.halves import require_equal_halves
from cranktopo.design.named import with_values
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.throw.counterweight.table import Counterweight

_HALF_ANGLE_DEG = 60.0
"""Of a web that has no counterweight yet."""
_DIGITS = 2
_LARGEST = 3.0
"""Largest outer radius that is looked at, over the throw radius."""


class ProposedCounterweight(Result):
    """The sector that balances a share of the oscillating mass beside all rotating masses."""

    share_percent: float
    """Share of the oscillating mass that is asked for."""
    outer_radius_mm: float
    half_angle_deg: float
    thickness_mm: float
    balance_factor_percent: float
    """Share that the throw balances with it."""
    refused: str | None
    """Reason for which the scene has no place for it; null where it fits."""


def with_share(scene: Scene, percent: float) -> Scene:
    """Return the scene with another share of the oscillating masses to be balanced."""
    engine = engine_of(scene)
    arranged = engine.arranged.model_copy(update={"balanced_oscillating_share": percent / 100})
    return scene.model_copy(update={"engine": engine.model_copy(update={"arrangement": arranged})})


def propose_counterweight(scene: Scene, percent: float) -> ProposedCounterweight:
    """Return the outer radius with which a web's counterweight balances a share of the oscillating mass.

    Angle, thickness and face stay as they are; a web without one gets a sector of 60 deg to both sides.

    Raises:
        CranktopoError: different webs, no oscillating mass, or no radius that balances so much or so little.
    """
    from scipy.optimize import brentq

    require_equal_halves(scene)
    if not rods_kg_mm(scene)[1]:
        raise invalid("engine.masses", None, "must be given: without them nothing oscillates")

    def excess(radius_mm: float) -> float:
        return (throw_balance(_weighted(scene, radius_mm)).balance_factor_percent or 0.0) - percent

    low, high = scene.throw.main_journal.radius_mm, _LARGEST * scene.throw.radius_mm
    if excess(low) > 0 or excess(high) < 0:
        side = "already has more without one" if excess(low) > 0 else "needs another angle or thickness"
        raise CranktopoError(
            f"--propose {percent:g}%: no outer radius of web.counterweight gives it.",
            hint=f"The throw {side}.",
        )
    radius = round(float(brentq(excess, low, high, xtol=1e-6)), _DIGITS)
    found = _weighted(scene, radius)
    weight, refused = found.web.counterweight, None
    assert weight is not None
    try:
        with_values(found, {})
    except CranktopoError as error:
        refused = error.message
    return ProposedCounterweight(
        share_percent=percent,
        outer_radius_mm=radius,
        half_angle_deg=weight.half_angle_deg,
        thickness_mm=weight.thickness_mm or scene.web.thickness_mm,
        balance_factor_percent=throw_balance(found).balance_factor_percent or 0.0,
        refused=refused,
    )


def _weighted(scene: Scene, radius_mm: float) -> Scene:
    own = scene.web.counterweight or Counterweight(outer_radius_mm=radius_mm, half_angle_deg=_HALF_ANGLE_DEG)
    weight = own.model_copy(update={"outer_radius_mm": radius_mm})
    return scene.model_copy(update={"web": scene.web.model_copy(update={"counterweight": weight})})
