"""The whole shaft with its mass in the oil films that carry it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.errors import solver_error
from cranktopo.base.frames import about_z_deg
from cranktopo.base.units import angular_speed_rad_s
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.numerics.bearing_film.in_motion import (
    STEADIER,
    CarriedShaft,
    FilmSlopes,
    MovingJournals,
    axis_rows,
    moving_journals,
)
from cranktopo.numerics.bearing_film.whirl import multipliers
from cranktopo.numerics.harmonic_balance import DampedBody, harmonics_of
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RY, RZ, UX, UY, UZ
from cranktopo.numerics.turning_body import TurningBody
from cranktopo.tasks.dynamics.assembled import assembled
from cranktopo.tasks.dynamics.moving_shaft import MovingCycle, MovingShaft, ShaftHarmonics
from cranktopo.tasks.film.stage import main_bearing
from cranktopo.tasks.modes.shaft_model import MOTIONS
from cranktopo.tasks.shaft.cycle import CycleForces, shaft_cycle
from cranktopo.tasks.shaft.on_film import bent_into_bearings, film_offsets_mm

_STEADY = 1.001
"""Growth of a disturbance over a cycle up to which it is none: a swing that nothing damps keeps its size."""
_SLOW = 0.02
"""Frequency over the speed at which a shaft that turns freely is made to swing as a whole: adrift, it would
seem to grow by what little its mesh is not round."""


def cycle_on_film(shaft: MovingShaft, scene: Scene, forces: CycleForces) -> MovingCycle:
    """Solve the steady vibration of a shaft in the films of a scene at its speed.

    Raises:
        CranktopoError: no `[bearings]`, no steady cycle, or one in which disturbances grow.
    """
    harmonics = ShaftHarmonics(shaft, forces)
    journals = journals_in_film(shaft, scene, forces, harmonics.on_bearings())
    check_steady(shaft, scene, journals.slopes)
    clearance = np.array([[main_bearing(scene, number).clearance_mm] for number in shaft.borne_by])
    cycle = harmonics.cycle(axis_rows(clearance * journals.eccentricity))
    return replace(cycle, film_work_J=journals.film_work_J)


def journals_in_film(
    shaft: MovingShaft, scene: Scene, forces: CycleForces, moving: CarriedShaft
) -> MovingJournals:
    """Return where films and a shaft are in balance over the cycle, from the shaft without mass on.

    Args:
        moving: the shaft with its mass.

    Raises:
        CranktopoError: no `[bearings]`, or no steady cycle.
    """
    throws, numbers, tilt = [one.still for one in shaft.throws], list(shaft.borne_by), shaft.tilt_Nmm_per_rad
    rigid = shaft_cycle(
        throws,
        shaft.angles_deg,
        forces,
        None,
        numbers,
        tilt_Nmm_per_rad=tilt,
        rigid_at=shaft.rigid_at,
    )
    bearings = [main_bearing(scene, number) for number in numbers]
    clearance = np.array([[bearing.clearance_mm] for bearing in bearings])
    start_mm = film_offsets_mm(throws, scene, rigid)
    turned = np.arange(len(start_mm)).reshape(-1, 2)[:, ::-1].ravel()  # x and y of each to y and x
    held = harmonics_of(-rigid.bearing_N[numbers].reshape(start_mm.shape)[turned])
    bent = bent_into_bearings(throws, scene)[np.ix_(turned, turned)]
    still = CarriedShaft(held, np.broadcast_to(bent.astype(complex), (held.shape[1], *bent.shape)))
    start = (start_mm[1::2] + 1j * start_mm[::2]) / clearance
    cycle_rad = math.radians(engine_of(scene).cycle_deg)
    return moving_journals(bearings, forces.angular_speed_rad_s, cycle_rad, still, moving, start)


def check_steady(shaft: MovingShaft, scene: Scene, films: FilmSlopes) -> None:
    """Refuse a cycle that a disturbance leads away from; raises CranktopoError."""
    engine = engine_of(scene)
    speed = angular_speed_rad_s(engine.speed_rpm)
    last = 6 * len(shaft.throws)
    held = {last + UZ} if shaft.turns_freely else {last + UZ, last + RZ}
    whole = assembled(shaft, scene)
    body, around = (
        whole.damped,
        np.array([one.motion == MOTIONS[RZ] for one in whole.coordinates], dtype=float),
    )
    springs = np.zeros_like(around)
    springs[[6 * one + motion for one in shaft.borne_by for motion in (RX, RY)]] = shaft.tilt_Nmm_per_rad
    springs[last + RZ] = around @ body.body.mass @ around * (_SLOW * speed) ** 2
    free = np.array([one for one in range(len(around)) if one not in held])
    journals = [6 * section + motion for section in shaft.borne_by for motion in (UY, UX)]
    step_s = math.radians(engine.cycle_deg) / speed / len(films.by_load)
    grown = multipliers(
        of_unknowns(body, free, np.diag(springs)),
        about_z_deg(1.0) * speed,
        np.searchsorted(free, journals),
        films,
        step_s,
    )
    most = float(np.abs(grown[0]))
    if most > _STEADY:
        raise solver_error(
            f"oil film: {engine.speed_rpm:g} rpm: the journals of the shaft with its mass whirl; "
            f"a disturbance of the steady cycle grows {most:.3g} times a cycle.",
            STEADIER,
        )


def of_unknowns(body: DampedBody, kept: NDArray[np.intp], stiffness: Array) -> DampedBody:
    """Return a body on more stiffness, of whose unknowns some are left."""
    chosen = np.eye(len(stiffness))[:, kept]
    own = body.body + replace(TurningBody.of_nothing(len(stiffness)), stiffness=stiffness)
    block = np.ix_(kept, kept)
    return DampedBody(own.over(chosen), body.loss[block], body.viscous[block])
