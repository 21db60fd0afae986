"""Load states between which the stresses of a throw alternate: joined extremes, or the whole cycle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import NMM_PER_NM, angular_speed_rad_s
from cranktopo.design.engine import Engine
from cranktopo.design.misfire import all_firing
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import Cycle, LoadAnalysis, analyse, at_worst_speed, engine_of
from cranktopo.engine.forces import ThrowForces
from cranktopo.engine.states import ExtremeState, extreme_states
from cranktopo.engine.vibration.shaft_chain import rods_shares

HistoryKind = Literal["extremes", "cycle"]
CURVES = ("radial_N", "tangential_N", "torque_Nm", "angular_speed_rad_s")
"""Attributes of a history with a value for each state."""
_QUANTITY_OF = {
    "bending": "radial_N",
    "torsion": "torque_Nm",
    "tangential": "tangential_N",
    "centrifugal": "angular_speed_rad_s",
}
"""Quantity of a history that an effect switches."""
_STEP_DEG = 1.0
_JOINED = " radial force with "


@dataclass(frozen=True)
class LoadHistory:
    """Load states of a throw, forces of the full throw; arrays of shape (states,).

    Attributes:
        radial_N: on the pin along -y.
        tangential_N: on the pin along +x, the direction of rotation.
        torque_Nm: that the throw passes on, mean of its two ends.
        swing_Nm: in the sense of rotation, of the throw's own mass where the shaft vibrates: its ends differ
            by this and by the torque of the pin; None where nothing swings.
    """

    radial_N: Array
    tangential_N: Array
    torque_Nm: Array
    angular_speed_rad_s: Array
    labels: tuple[str, ...]
    swing_Nm: Array | None = field(default=None, kw_only=True)

    @property
    def own_swing_Nm(self) -> Array:
        """Torque of the throw's own mass in every state, N m; 0 where nothing swings."""
        return np.zeros_like(self.torque_Nm) if self.swing_Nm is None else self.swing_Nm


@dataclass(frozen=True)
class WebHistory(LoadHistory):
    """Load states of a throw that stands alone, under which its near half carries what a web of a shaft does.

    Attributes:
        moment_Nm, side_moment_Nm: on its near section about +x and about +y, opposite ones on the far one.
    """

    moment_Nm: Array
    side_moment_Nm: Array


@dataclass(frozen=True)
class WebLoads:
    """Loads of a web, or of webs that are to be equal, in a shaft on all its bearings.

    Attributes:
        histories: one for each such web and speed; each is judged by itself, and on the near half alone.
    """

    histories: tuple[WebHistory, ...]


Loads = HistoryKind | WebLoads
"""Load states of a throw that stands alone, or of webs in their shaft."""
LoadsName = Literal["extremes", "cycle", "shaft"]


def loads_name(loads: Loads) -> LoadsName:
    """Return the word for load states in results."""
    return "shaft" if isinstance(loads, WebLoads) else loads


def rated_histories(scene: Scene, kind: HistoryKind, enabled: frozenset[str]) -> Sequence[LoadHistory]:
    """Return the histories of the engine's speed, and of a vibrating shaft of its worst speed too.

    Over the cycle these are each throw's own, and each speed's where the shaft vibrates: no throw passes
    through the states of another one, and no cycle through those of two speeds.
    """
    return cycle_histories(scene, enabled) if kind == "cycle" else (load_history(scene, kind, enabled),)


def joins_extremes(label: str) -> bool:
    """Tell whether a load state, by its label, joins extremes that the throw need not have at once."""
    return _JOINED in label


def speed_words(speed_rpm: float) -> str:
    """Return the end of the label of a load state that tells its speed."""
    return f", {speed_rpm:.0f} rpm"


def load_history(scene: Scene, kind: HistoryKind, enabled: frozenset[str]) -> LoadHistory:
    """Return the load states of a scene; raises CranktopoError where the scene does not tell the loads.

    "extremes" joins the largest and the smallest radial force with the largest and the smallest torque of
    the shaft: four states that bound both over the cycle and never occur themselves. A smallest value that
    the scene does not tell, or a computed one above zero, counts as zero, and so does a largest one below
    it. "cycle" joins `cycle_histories`. With `torsional_vibration` the torques are those of the vibrating
    shaft, at its worst speed too. A load whose effect is not enabled stays zero. All cylinders fire, also
    where `engine.misfire` names some that do not.
    """
    if kind == "cycle":
        return _joined(cycle_histories(scene, enabled))
    scene = all_firing(scene)
    _check_engine(scene)
    return _enabled_loads(_extremes(scene, enabled), enabled)


def cycle_histories(scene: Scene, enabled: frozenset[str]) -> list[LoadHistory]:
    """Return the cycle of every throw at the engine's speed, of a vibrating shaft also at its worst speed.

    Errors as of `load_history`.
    """
    _check_engine(scene)
    if "torsional_vibration" not in enabled:
        return throw_histories(scene, enabled)
    scene = all_firing(scene)
    speeds = scene, at_worst_speed(scene, enabled)
    return [
        replace(one, labels=tuple(f"{label}{speed_words(engine_of(at).speed_rpm)}" for label in one.labels))
        for at in speeds
        for one in throw_histories(at, enabled)
    ]


def _check_engine(scene: Scene) -> None:
    if scene.engine is None:
        raise CranktopoError(
            "engine: is missing, so the loads are unit loads without a stress level.",
            hint="Add an [engine] table with gas, or with max_gas_force_N and max_torque_Nm.",
        )


def tangential_range_N(scene: Scene, enabled: frozenset[str]) -> float:
    """Return the range of the tangential force on a pin, which the torque of the other throws has no part in.

    Where the scene tells the torque of the shaft alone, all of it is taken as that of one throw.
    """
    known = [cycle.extreme("tangential_force_N") for cycle in _cycles(scene, enabled)]
    if not known:
        history = load_history(scene, "extremes", enabled)
        return float(np.ptp(history.torque_Nm)) * NMM_PER_NM / scene.throw.radius_mm
    return max(high.value for high, _ in known) - min(low.value for _, low in known)


def radial_amplitude_N(scene: Scene, kind: HistoryKind, enabled: frozenset[str]) -> float:
    """Return the largest amplitude of the radial force on any web, over the cycle at one speed.

    Joined extremes have one amplitude, which no web exceeds.
    """
    return max(float(np.ptp(one.radial_N)) for one in rated_histories(scene, kind, enabled)) / 2


def torque_amplitude_Nm(scene: Scene, kind: HistoryKind, enabled: frozenset[str]) -> float:
    """Return the torque amplitude that no section ahead of or behind a throw exceeds.

    A cycle is a throw's own, with the mean torque of its ends, and each end swings by its own amplitude: the
    largest of these counts. Joined extremes hold both ends already.
    """
    if "torsion" not in enabled:
        return 0.0
    if kind == "extremes":
        return float(np.ptp(load_history(scene, kind, enabled).torque_Nm)) / 2
    swings = [np.ptp(cycle.torque.sections_Nm, axis=1) for cycle in _cycles(all_firing(scene), enabled)]
    return float(np.max(swings)) / 2


def _cycles(scene: Scene, enabled: frozenset[str]) -> list[Cycle]:
    """Return the cycle at the engine's speed, of a vibrating shaft also that at its worst speed; if known."""
    vibrating = "torsional_vibration" in enabled
    speeds = (scene, at_worst_speed(scene, enabled)) if vibrating else (scene,)
    cycles = (analyse(at, enabled).cycle for at in speeds)
    return [cycle for cycle in cycles if cycle is not None]


def _extremes(scene: Scene, enabled: frozenset[str]) -> LoadHistory:
    return joined_extremes(
        analyse(scene, enabled), extreme_states(scene, enabled), _cycles(scene, enabled)[1:]
    )


def joined_extremes(
    analysis: LoadAnalysis, extremes: Sequence[ExtremeState], others: Sequence[Cycle] = ()
) -> LoadHistory:
    """Return the extremes of `load_history` from the extreme states and the analysis of a scene.

    Args:
        others: cycles at further speeds, of which the one counts whose radial forces range more.
    """
    states = {state.name: state for state in extremes}
    radial, torque = states["max_radial"], states["max_torque"]
    for state, key in ((radial, "max_gas_force_N"), (torque, "max_torque_Nm")):
        if state.unit:
            raise CranktopoError(
                f"engine.{key}: is missing, so this load is a unit load without a stress level.",
                hint=f"Give engine.{key}, or [engine.gas].",
            )
    high_radial, low_radial = _radial_extremes_N(analysis, others, radial.case.radial_N)
    low_torque = states["min_torque"].case.torque_Nm if "min_torque" in states else 0.0
    if analysis.engine.min_torque_Nm is not None:
        low_torque = analysis.engine.min_torque_Nm
    speed = angular_speed_rad_s(analysis.engine.speed_rpm)
    forces = {"largest": high_radial, "smallest": low_radial}
    torques = {"largest": torque.case.torque_Nm, "smallest": low_torque}
    pairs = [(force, twist) for force in forces for twist in torques]
    return LoadHistory(
        np.array([forces[force] for force, _ in pairs]),
        np.zeros(len(pairs)),
        np.array([torques[twist] for _, twist in pairs]),
        np.full(len(pairs), speed),
        tuple(f"{force}{_JOINED}{twist} torque" for force, twist in pairs),
    )


def extremes_at(scene: Scene, extremes: Sequence[ExtremeState], enabled: frozenset[str]) -> LoadHistory:
    """Return the joined extremes of a scene at its own speed, with torques that may be those of another."""
    return _enabled_loads(joined_extremes(analyse(scene, enabled), extremes), enabled)


def _radial_extremes_N(
    analysis: LoadAnalysis, others: Sequence[Cycle], gas_force_N: float
) -> tuple[float, float]:
    """Largest and smallest radial force on a web over a cycle; of a given gas force that and none.

    Of several cycles it is that with the largest range: of two speeds joined it would be one that no web has.

    Where inertia outweighs the gas, the load case of bending is the smallest force, and tells no other end.
    """
    if analysis.cycle is None or analysis.engine.max_gas_force_N is not None:
        return max(gas_force_N, 0.0), min(gas_force_N, 0.0)
    found = [cycle.extreme("web_force_N") for cycle in (analysis.cycle, *others)]
    high, low = max(found, key=lambda ends: ends[0].value - ends[1].value)
    return high.value, low.value


def throw_histories(scene: Scene, enabled: frozenset[str]) -> list[LoadHistory]:
    """Return the cycle of every throw at the engine's speed, all cylinders firing."""
    scene = all_firing(scene)
    return [_enabled_loads(one, enabled) for one in _throw_cycles(scene, enabled)]


def _joined(parts: Sequence[LoadHistory]) -> LoadHistory:
    joined = {name: np.concatenate([getattr(part, name) for part in parts]) for name in CURVES}
    swings = any(part.swing_Nm is not None for part in parts)
    return LoadHistory(
        **joined,
        labels=tuple(label for part in parts for label in part.labels),
        swing_Nm=np.concatenate([part.own_swing_Nm for part in parts]) if swings else None,
    )


def _throw_cycles(scene: Scene, enabled: frozenset[str]) -> list[LoadHistory]:
    engine, cycle = engine_of(scene), analyse(scene, enabled).cycle
    if cycle is None:
        raise CranktopoError(
            "engine.gas: is missing, so there is no cycle to follow.",
            hint="Add [engine.gas], or take the extreme states.",
        )
    angle = cycle.forces.angle_deg[:: every_degree(cycle.forces.angle_deg)]
    speed = np.full(len(angle), angular_speed_rad_s(engine.speed_rpm))
    found = [
        LoadHistory(
            *_throw(engine, cycle, angle, rods.throw, forces),
            speed,
            tuple(f"{rods.name}, {a:g} deg" for a in angle),
        )
        for rods, forces in cycle.pins
    ]
    if not cycle.torque.vibrates:
        return found
    shares = rods_shares(scene)
    return [
        _swinging(
            one,
            _inertia_Nm(engine, cycle, angle, rods.throw, forces),
            shares[rods.throw],
            scene.throw.radius_mm,
        )
        for one, (rods, forces) in zip(found, cycle.pins, strict=True)
    ]


def _inertia_Nm(engine: Engine, cycle: Cycle, angle: Array, throw: int, forces: ThrowForces) -> Array:
    """Torque between both ends of a throw of a vibrating shaft, less that of its rods; angles of `_throw`."""
    between = cycle.torque.sections_Nm[throw + 1] - cycle.torque.sections_Nm[throw]
    shaft, cycle_deg = angle + engine.firing_angles_deg[throw], engine.cycle_deg
    both = np.interp(shaft, forces.angle_deg, between, period=cycle_deg)
    return np.asarray(both - np.interp(angle, forces.angle_deg, forces.torque_Nm, period=cycle_deg))


def _swinging(history: LoadHistory, inertia_Nm: Array, rods_share: float, radius_mm: float) -> LoadHistory:
    """Return a history with that torque: the share of rods and pistons pushes the pin, the rest is spread."""
    at_pin = rods_share * inertia_Nm * NMM_PER_NM / radius_mm
    return replace(
        history, tangential_N=history.tangential_N + at_pin, swing_Nm=(1 - rods_share) * inertia_Nm
    )


def every_degree(angle_deg: Array) -> int:
    """Return the stride through even angles that leaves about one a degree."""
    return max(1, round(_STEP_DEG / float(np.diff(angle_deg[:2])[0])))


def _throw(
    engine: Engine, cycle: Cycle, angle: Array, throw: int, forces: ThrowForces
) -> tuple[Array, Array, Array]:
    """Radial and tangential force and mean torque of a throw, at angles after its own firing dead centre."""
    shaft = angle + engine.firing_angles_deg[throw]

    def at(curve: Array, where: Array) -> Array:
        return np.interp(where, forces.angle_deg, curve, period=engine.cycle_deg)

    behind, ahead = at(cycle.torque.passed_on_Nm[throw], shaft), cycle.torque.ahead_Nm
    own = at(forces.torque_Nm, angle) if ahead is None else behind - at(ahead[throw], shaft)
    mean = behind - own / 2
    return at(forces.web_force_N, angle), at(forces.tangential_force_N, angle), mean


def _enabled_loads(history: LoadHistory, enabled: frozenset[str]) -> LoadHistory:
    kept = {
        quantity: getattr(history, quantity) * (1.0 if effect in enabled else 0.0)
        for effect, quantity in _QUANTITY_OF.items()
    }
    return LoadHistory(
        **kept, labels=history.labels, swing_Nm=history.swing_Nm if "torsion" in enabled else None
    )
