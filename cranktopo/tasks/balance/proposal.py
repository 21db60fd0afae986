"""The counterweight of a throw that balances a wanted share of the oscillating mass."""

from __future__ import annotations

from functools import cache

import numpy as np

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.base.root import root
from cranktopo.bodies.volume import counterweight_mass
from cranktopo.design.balance_factor import rods_kg_mm
from cranktopo.design.clearance import pin_in_the_way, room_words
from cranktopo.design.crank_throws import refuse_split_pins
from cranktopo.design.draft import flank_draft_words, largest_half_angle_deg
from cranktopo.design.halves import difference
from cranktopo.design.named import with_values
from cranktopo.design.schema import Scene
from cranktopo.design.shape import ShapeTable
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.balance.throw import throw_balance, throw_factor_percent
from cranktopo.throw.counterweight.table import Counterweight

_HALF_ANGLE_DEG = 60.0
"""Of a web that has no counterweight yet."""
OTHER_ANGLES_DEG = 20.0, 90.0, 10.0
"""First, last and step of the half-angles that are tried where that of the web finds no place."""
_DIGITS = 2
_OF_A_CUBE = 1e-7
"""Share of the cube of the least radius to which that of the found one is known."""
_PROBES = 4
"""Radii at which it is asked for what refuses any counterweight."""
_ADDS = 1e-6
"""Mass of a counterweight that reaches beyond the web, over that of the throw."""
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
    """Reason for which the scene has no place for it; null where none is known."""
    room: str | None = None
    """Room that piston and crankcase leave beside it, in words; null where the scene names neither."""
    own_angle_refused: str | None = UNLESS_NONE
    """Why the web's own half-angle, or the usual 60 deg, was left for another one that fits."""
    draft: str | None = UNLESS_NONE
    """Draft that its flanks lack, in words, where the process asks for more than they have."""


def with_share(scene: Scene, percent: float) -> Scene:
    """Return the scene with another share of the oscillating masses to be balanced."""
    engine = engine_of(scene)
    arranged = engine.arranged.model_copy(update={"balanced_oscillating_share": percent / 100})
    return scene.model_copy(update={"engine": engine.model_copy(update={"arrangement": arranged})})


def propose_counterweight(scene: Scene, percent: float) -> ProposedCounterweight:
    """Return the counterweight of a web that balances a share of the oscillating mass, or the rotating alone.

    Its outer radius is found; thickness and face stay as they are, and the half-angle does where the scene
    has a place for it: 60 deg for a web without a counterweight. Elsewhere the nearest half-angle that fits
    is taken, those whose flanks have the draft asked for first, or none: then the result says what refuses
    it.

    Raises:
        CranktopoError: different webs, no oscillating mass, or no radius that balances so much or so little.
    """
    _require_equal_halves(scene)
    refuse_split_pins(
        scene,
        "--propose sizes the counterweights of a throw with a straight pin",
        "Without --propose, balance says what each web needs.",
    )
    if not rods_kg_mm(scene)[1]:
        raise invalid("engine.masses", None, "must be given: without them nothing oscillates")
    own_deg = scene.web.counterweight.half_angle_deg if scene.web.counterweight else _HALF_ANGLE_DEG
    own = found = _at_angle(scene, percent, own_deg)
    barred = (own is None or own.refused) and _barred(scene)
    for angle_deg in [] if barred else _other_angles_deg(scene, own_deg):
        if found is not None and not found.refused:
            break
        found = _at_angle(scene, percent, angle_deg)
        own = own or found
    if own is None:
        raise _no_radius(scene, percent, own_deg)
    if found is None or found.refused:
        return own
    if found.half_angle_deg == own_deg:
        return found
    why = own.refused if own.half_angle_deg == own_deg else "no outer radius balances so much"
    return found.model_copy(update={"own_angle_refused": why})


def _require_equal_halves(scene: Scene) -> None:
    key = difference(scene)
    if not key:
        return
    drilled = key.startswith("throw.drilling")
    copy = f"{key} = 'both', or without that drilling" if drilled else "two equal halves"
    raise CranktopoError(
        f"{key}: the halves of the throw differ, and --propose sizes one counterweight for both webs.",
        hint=f"Propose on a copy of the design with {copy}. Without --propose, balance takes this design "
        "and says what each of its webs needs.",
    )


def _other_angles_deg(scene: Scene, own_deg: float) -> list[float]:
    """Half-angles to be tried beside the own one, nearest first; those with less draft than asked last."""
    first, last, step = OTHER_ANGLES_DEG
    most = largest_half_angle_deg(scene)
    angles = {*np.arange(first, last + step / 2, step).tolist(), most} - {own_deg}
    return sorted(angles, key=lambda angle: (angle > most, abs(angle - own_deg)))


def _at_angle(scene: Scene, percent: float, angle_deg: float) -> ProposedCounterweight | None:
    """Return the counterweight of a half-angle; None where no outer radius balances the share.

    It is sought by the cube of the radius, of which the unbalance of a sector is a straight line.
    """

    @cache
    def excess(cube_mm3: float) -> float:
        return _factor_percent(_weighted(scene, cube_mm3 ** (1 / 3), angle_deg)) - percent

    low, high = scene.throw.main_journal.radius_mm**3, (_LARGEST * scene.throw.radius_mm) ** 3
    if excess(low) > 0 or excess(high) < 0:
        return None
    radius = round(root(excess, low, high, _OF_A_CUBE * low) ** (1 / 3), _DIGITS)
    found = _weighted(scene, radius, angle_deg)
    weight = found.web.counterweight
    assert weight is not None
    return ProposedCounterweight(
        share_percent=percent,
        outer_radius_mm=radius,
        half_angle_deg=angle_deg,
        thickness_mm=weight.thickness_mm or scene.web.thickness_mm,
        balance_factor_percent=_factor_percent(found),
        refused=_refusal(found),
        room=room_words(found) or None,
        draft=flank_draft_words(found) or None,
    )


def _refusal(scene: Scene) -> str | None:
    error = _error(scene)
    return error.message if error else pin_in_the_way(scene) or None


def _error(scene: Scene) -> CranktopoError | None:
    """Return the refusal of a scene; None where it is sound."""
    try:
        with_values(scene, {})
    except CranktopoError as error:
        return error
    return None


def _factor_percent(scene: Scene) -> float:
    return throw_factor_percent(scene) or 0.0


def _no_radius(scene: Scene, percent: float, angle_deg: float) -> CranktopoError:
    """Return the reason for which no counterweight balances a share, and what would help."""
    asked, least_mm = f"--propose {percent:g}%", scene.throw.main_journal.radius_mm
    if _factor_percent(_weighted(scene, least_mm, angle_deg)) > percent:
        hint = "The throw already has more without one."
        return CranktopoError(f"{asked}: no outer radius of web.counterweight gives it.", hint=hint)
    barred = _barred(scene)
    if barred is not None:
        return CranktopoError(f"{asked}: no counterweight has a place: {barred.message}", hint=barred.hint)
    return CranktopoError(
        f"{asked}: no outer radius of web.counterweight gives it, "
        f"up to {_LARGEST * scene.throw.radius_mm:.4g} mm.",
        hint=f"The throw needs {_heavier(scene)}.",
    )


def _barred(scene: Scene) -> CranktopoError | None:
    """Return what refuses a counterweight of every size that is looked at; None where one of them fits.

    That is the refusal of the smallest that reaches beyond the web.
    """
    least, most = scene.throw.main_journal.radius_mm, _LARGEST * scene.throw.radius_mm
    first, last, _ = OTHER_ANGLES_DEG
    refusal: CranktopoError | None = None
    for angle_deg in (_HALF_ANGLE_DEG, last, first):
        for radius_mm in np.geomspace(least, most, _PROBES + 2)[1:-1].tolist():
            weighted = _weighted(scene, round(radius_mm, _DIGITS), angle_deg)
            error = _error(weighted)
            if error is None:
                return None
            if counterweight_mass(weighted).volume > _ADDS * throw_balance(scene).mass_kg:
                refusal = refusal or error
    return refusal


def _heavier(scene: Scene) -> str:
    """Return what gives a counterweight more mass than every radius does."""
    weight = scene.web.counterweight
    if weight is not None and weight.thickness_mm and weight.thickness_mm < scene.web.thickness_mm:
        return f"a thicker counterweight: it may have web.thickness_mm, {scene.web.thickness_mm:g} mm"
    return "a thicker web, or a heavier counterweight: web.counterweight.plug or its density_kg_m3"


def _weighted(scene: Scene, radius_mm: float, angle_deg: float) -> Scene:
    weight = Counterweight(outer_radius_mm=radius_mm, half_angle_deg=angle_deg)
    if scene.web.counterweight is not None:
        sizes = {"outer_radius_mm": radius_mm, "half_angle_deg": angle_deg}
        weight = scene.web.counterweight.model_copy(update=sizes)
    web = scene.web.model_copy(update={"counterweight": weight})
    without_ranges = ShapeTable()  # which would refuse sizes beyond them
    return scene.model_copy(update={"web": web, "shape": without_ranges})
