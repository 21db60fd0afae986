"""The whole shaft with its mass at the speeds of a cycle, beside the shaft without mass."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import zip_longest

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode, invalid
from cranktopo.base.notes import note
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import ShaftTable
from cranktopo.engine.analysis import at_speed, engine_of
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RY, RZ, UX, UY, UZ
from cranktopo.tasks.dynamics.moving_shaft import MovingCycle, MovingShaft, moving_cycle, moving_shaft
from cranktopo.tasks.dynamics.moving_throw import moving_throw, pin_friction_Ns_per_mm
from cranktopo.tasks.dynamics.on_film import cycle_on_film
from cranktopo.tasks.dynamics.resonance import OrderCrossing, crossings_of
from cranktopo.tasks.dynamics.result import (
    DynamicBearing,
    DynamicSpeed,
    DynamicWeb,
    MomentRanges,
    Resonance,
    SectionSwing,
    ShaftDynamics,
)
from cranktopo.tasks.film.permitted import permitted_films
from cranktopo.tasks.film.result import BearingFilm
from cranktopo.tasks.film.stage import films_of
from cranktopo.tasks.modes.carried import without_mass
from cranktopo.tasks.shaft.assembly import Bearings, ShaftBearings
from cranktopo.tasks.shaft.condensed_throw import once_each
from cranktopo.tasks.shaft.continuous import filmed_by, loaded_journals
from cranktopo.tasks.shaft.cycle import cycle_forces, shaft_cycle
from cranktopo.tasks.shaft.loaded_throw import ThrowBody
from cranktopo.tasks.shaft.result import ContinuousShaft
from cranktopo.tasks.shaft.web_sections import WebSections, web_sections
from cranktopo.tasks.throw_fea.targets import Target

_SAME_RPM = 0.5
"""Difference up to which a resonance is one of the speeds asked for."""
_FELT = 0.05
"""Change of a web's equivalent moment from which a resonance is told."""
_SHEAR = math.sqrt(3) / 2
"""Of a round section: the torque that strains it as a bending moment of 1 does, by von Mises."""


@dataclass(frozen=True)
class DynamicShaft:
    """A shaft with mass, to be solved at any speed.

    Attributes:
        scenes: of its throws, from the free end.
        bearings, spring_N_per_mm: what carries it.
    """

    moving: MovingShaft
    scene: Scene
    scenes: tuple[Scene, ...]
    bearings: ShaftBearings
    spring_N_per_mm: float | None

    def cycle(self, speed_rpm: float) -> MovingCycle:
        """Return its steady vibration at a speed, solved once."""
        if speed_rpm not in self._solved:
            at = at_speed(self.scene, speed_rpm)
            if self.bearings == "film":
                note(f"{self.scene.name}: the shaft with its mass in oil films at {speed_rpm:g} rpm")
                self._solved[speed_rpm] = cycle_on_film(self.moving, at, cycle_forces(at))
            else:
                self._solved[speed_rpm] = moving_cycle(self.moving, cycle_forces(at))
        return self._solved[speed_rpm]

    @cached_property
    def _solved(self) -> dict[float, MovingCycle]:
        return {}

    def with_resonances(
        self, speeds_rpm: Sequence[float]
    ) -> tuple[tuple[float, ...], tuple[Resonance, ...], float | None]:
        """Return speeds with the worst resonance between them, all that are felt, and that which was added.

        Of one speed there are none, nor in oil films, in which the shaft has no modes of its own.
        """
        speeds = tuple(speeds_rpm)
        if len(speeds) < 2 or self.bearings == "film":
            return speeds, (), None
        spring = self.spring_N_per_mm or 0.0
        held: Bearings = "rigid" if self.spring_N_per_mm is None else "spring"
        throws = [throw.reduced for throw in self.moving.throws]
        met = crossings_of(throws, self.scene, held, spring, (min(speeds), max(speeds)))
        note(f"{self.scene.name}: {len(met)} crossings of orders and modes of the shaft")
        moments = {one: self._moments(one.speed_rpm) for one in met}
        felt = tuple(_resonance(one, moments[one], self._still_moments(one.speed_rpm)) for one in met)
        worst = max(met, key=lambda one: moments[one].max(), default=None)
        told = tuple(one for one in felt if abs(one.ratio - 1) >= _FELT)
        asked = max(self._moments(rpm).max() for rpm in speeds)
        if worst is None or moments[worst].max() <= asked:
            return speeds, told, None
        if min(abs(worst.speed_rpm - speed) for speed in speeds) < _SAME_RPM:
            return speeds, told, None
        return tuple(sorted((*speeds, worst.speed_rpm))), told, worst.speed_rpm

    def _moments(self, speed_rpm: float) -> Array:
        """Return the equivalent moments of all webs, (webs,)."""
        return _equivalents(web_sections(self.cycle(speed_rpm).shaft, self.scenes))

    def _still_moments(self, speed_rpm: float) -> Array:
        """Return those of the shaft without mass."""
        moving, forces = self.moving, cycle_forces(at_speed(self.scene, speed_rpm))
        still = shaft_cycle(
            [throw.still for throw in moving.throws],
            moving.angles_deg,
            forces,
            moving.spring_N_per_mm,
            moving.borne_by,
            tilt_Nmm_per_rad=moving.tilt_Nmm_per_rad,
            rigid_at=moving.rigid_at,
        )
        return _equivalents(web_sections(still, self.scenes))

    def result(
        self, on_bearings: Sequence[ContinuousShaft], resonances: tuple[Resonance, ...], added: float | None
    ) -> ShaftDynamics:
        """Return the vibration at the speeds of the shaft without mass, beside that."""
        table = self.scene.shaft or ShaftTable()
        states = self.cycle(on_bearings[0].speed_rpm).shaft.angle_deg.size
        every = self._films([at.speed_rpm for at in on_bearings])
        speeds = tuple(self._at(still, films) for still, films in zip(on_bearings, every, strict=True))
        return ShaftDynamics(
            loss_factor=table.throw_loss_factor,
            turns_freely=self.moving.turns_freely,
            highest_order=states // 2 * 360.0 / engine_of(self.scene).cycle_deg,
            unknowns=self.moving.unknowns,
            torsion_only=without_mass(table),
            speeds=speeds,
            resonances=resonances,
            added_speed_rpm=added,
            **permitted_films(self.scene.bearings, [film for at in speeds for film in at.least_films]),
        )

    def _films(self, speeds_rpm: Sequence[float]) -> list[tuple[BearingFilm, ...]]:
        """Return the films of all main bearings at each speed; none of other bearings than films."""
        if self.bearings != "film":
            return [()] * len(speeds_rpm)
        cases = []
        for rpm in speeds_rpm:
            at, cycle = at_speed(self.scene, rpm), self.cycle(rpm).shaft
            cases.append((at, loaded_journals(at, cycle), cycle.angle_deg))
        return films_of(cases, conserving=True)

    def _at(self, still: ContinuousShaft, films: Sequence[BearingFilm]) -> DynamicSpeed:
        cycle = self.cycle(still.speed_rpm)
        assert still.sections is not None
        curves = web_sections(cycle.shaft, self.scenes)
        pairs = zip(_ranges(curves), _ranges(still.sections), strict=True)
        return DynamicSpeed(
            speed_rpm=still.speed_rpm,
            webs=tuple(
                DynamicWeb(
                    web=number + 1,
                    throw=number // 2 + 1,
                    range_Nm=moved,
                    quasi_static_Nm=before,
                    ratio=moved.equivalent / before.equivalent,
                )
                for number, (moved, before) in enumerate(pairs)
            ),
            main_bearings=_bearings(cycle, still, films),
            sections=_swings(cycle),
            work_in_J=cycle.work_in_J,
            damping_work_J=cycle.damping_work_J,
            film_work_J=cycle.film_work_J,
            curves=curves,
        )


def dynamic_shaft(
    throws: Sequence[Target],
    bodies: Mapping[str, ThrowBody],
    scene: Scene,
    bearings: ShaftBearings,
    spring_N_per_mm: float | None,
) -> DynamicShaft:
    """Return the shaft of a scene with its mass; `bodies` are its throws by their names.

    Raises:
        CranktopoError: bearings in which it cannot vibrate, a material without damping, or a failed solve.
    """
    check_dynamics(scene, bearings)
    note(f"{scene.name}: the throws with their mass")
    loss = (scene.shaft or ShaftTable()).throw_loss_factor
    moving = once_each(
        throws,
        lambda one: moving_throw(bodies[one.name], one.scene, loss, pin_friction_Ns_per_mm(scene, one.scene)),
    )
    shaft = moving_shaft(moving, scene, spring_N_per_mm)
    return DynamicShaft(shaft, scene, tuple(one.scene for one in throws), bearings, spring_N_per_mm)


def check_dynamics(scene: Scene, bearings: ShaftBearings) -> None:
    """Refuse bearings that are free or have play, and a shaft whose bending nothing damps."""
    if bearings not in ("rigid", "spring", "film"):
        why = ": without oil, journals bounce in their play" if bearings == "clearance" else ""
        raise CranktopoError(
            f"--dynamic: --bearings {bearings} has no answer for a shaft with mass{why}.",
            hint="Choose --bearings rigid, spring or film.",
            code=ExitCode.USAGE,
        )
    if not (scene.shaft or ShaftTable()).throw_loss_factor:
        raise invalid(
            "shaft.throw_loss_factor",
            0.0,
            "nothing damps the bending of the shaft, so that a resonance has no limit",
            "Give a loss factor; 0.02 by default.",
        )


def _ranges(sections: WebSections) -> list[MomentRanges]:
    """Return the ranges in all webs from the free end."""
    curves = (sections.bending_Nm, sections.side_bending_Nm, sections.torque_Nm)
    bending, side, torque = (np.ptp(curve, axis=2).ravel() for curve in curves)
    equivalent = np.sqrt(bending**2 + side**2 + (_SHEAR * torque) ** 2)
    return [
        MomentRanges(bending=b, side_bending=s, torque=t, equivalent=e)
        for b, s, t, e in np.stack([bending, side, torque, equivalent], axis=1).tolist()
    ]


def _equivalents(sections: WebSections) -> Array:
    return np.array([one.equivalent for one in _ranges(sections)])


def _resonance(met: OrderCrossing, moved: Array, still: Array) -> Resonance:
    ratio = moved / still
    web = int(np.argmax(ratio))
    return Resonance(**vars(met), web=web + 1, ratio=float(ratio[web]))


def _bearings(
    cycle: MovingCycle, still: ContinuousShaft, films: Sequence[BearingFilm]
) -> tuple[DynamicBearing, ...]:
    size = np.hypot(cycle.shaft.bearing_N[:, 0], cycle.shaft.bearing_N[:, 1])
    found = []
    for before, film in zip_longest(still.main_bearings, films):
        own, least = size[before.bearing - 1], before.least(still.speed_rpm)
        filmed = {} if film is None else filmed_by(film)
        if film is not None and least is not None:
            filmed["quasi_static_film_um"] = least.film_um
        found.append(
            DynamicBearing(
                bearing=before.bearing,
                largest_N=float(own.max()),
                at_deg=float(cycle.shaft.angle_deg[own.argmax()]),
                quasi_static_N=before.largest_N,
                ratio=float(own.max()) / before.largest_N,
                **filmed,
            )
        )
    return tuple(found)


def _swings(cycle: MovingCycle) -> tuple[SectionSwing, ...]:
    motion = cycle.shaft.motion.reshape(-1, 6, cycle.shaft.angle_deg.size)
    return tuple(
        SectionSwing(
            section=section + 1,
            twist_deg=float(np.degrees(np.ptp(own[RZ]) / 2)),
            axial_um=float(np.ptp(own[UZ]) / 2 * 1e3),
            tilt_mrad=float(np.hypot(own[RX], own[RY]).max() * 1e3),
            offset_um=float(np.hypot(own[UX], own[UY]).max() * 1e3),
        )
        for section, own in enumerate(motion)
    )
