"""One throw of a crank whose throws differ: the one asked for, or the worst loaded."""

from __future__ import annotations

import math

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import note
from cranktopo.base.units import NMM_PER_NM
from cranktopo.design.crank import Crank
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.flying_web import flying_webs
from cranktopo.design.halves import WebName, halves
from cranktopo.design.misfire import all_firing, misfire
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse
from cranktopo.engine.throw_compliance import (
    journal_torsion_modulus_mm3,
    web_lever_mm,
    web_section_modulus_mm3,
)


def one_throw(scene: Scene, number: int | None = None, *, all_fire: bool = True) -> Scene:
    """Return the scene of one throw, with the ends of the crank; the scene itself where all are alike.

    Args:
        number: from the free end, 1 first; without one the worst loaded throw is taken, and named in a line.
        all_fire: leave `engine.misfire` out, with a line: a throw is judged in an engine that fires.

    Raises:
        CranktopoError: a number that no throw has, or one of throws that are all alike.
    """
    if all_fire and misfire(scene):
        note(f"{scene.name}: engine.misfire is left out: one throw is judged with all cylinders firing")
        scene = all_firing(scene)
    crank = scene.crank
    if crank is not None and crank.bearings:
        note(
            f"{scene.name}: a throw is modelled between two main bearings, also where crank.bearings has none"
        )
    for web in flying_webs(scene):
        note(f"{web.name}: `evaluate` tells its stiffness; no command judges its stress")
    if crank is None or crank.uniform:
        if number is not None:
            raise CranktopoError(
                f"--throw {number}: all throws of the crank are alike.",
                hint="Leave it out.",
                code=ExitCode.USAGE,
            )
        return scene
    throws = throw_scenes(scene)
    if number is not None and not 1 <= number <= len(throws):
        raise CranktopoError(
            f"--throw {number}: the crank has throws 1 to {len(throws)}.",
            hint="They count from the free end.",
            code=ExitCode.USAGE,
        )
    if number is None and len(throws) == 1:
        number = 1
    if number is None:
        stresses = nominal_stresses_MPa(scene)
        number = int(np.argmax(np.round(stresses, 6))) + 1
        note(
            f"{scene.name}: throw {number} of {len(throws)} is taken, the worst loaded "
            f"({stresses[number - 1]:.0f} MPa nominal); --throw N takes another"
        )
    ends = Crank(end=crank.end) if crank.end else None
    name = f"{scene.name}-throw-{number}" if len(throws) > 1 else scene.name
    return throws[number - 1].model_copy(update={"crank": ends, "name": name})


def worse_web(scene: Scene) -> WebName:
    """Return the web of a throw that the same pin force bends more, by nominal stress."""
    first, second = (web_lever_mm(half) / web_section_modulus_mm3(half) for half in halves(scene))
    return "second" if second > first else "first"


def nominal_stresses_MPa(scene: Scene) -> Array:
    """Return the nominal amplitude of each throw: bending of its weaker web, torsion of its weaker journal.

    Of loads that the scene does not tell unit ones are taken: 1 N, or no torque.
    """
    force, torques = _amplitudes(scene)
    found = []
    for throw, torque in zip(throw_scenes(scene), torques, strict=True):
        both = halves(throw)
        bend = force / 2 * max(web_lever_mm(half) / web_section_modulus_mm3(half) for half in both)
        journals = [journal for half in both for journal, _ in half.throw.journals]
        shear = torque * NMM_PER_NM / min(map(journal_torsion_modulus_mm3, journals))
        found.append(math.hypot(bend, math.sqrt(3) * shear))
    return np.array(found)


def _amplitudes(scene: Scene) -> tuple[float, Array]:
    """Half the range of the radial force, N, and of the torque ahead of or behind each throw, N m."""
    throws = len(throw_scenes(scene))
    cycle = analyse(all_firing(scene)).cycle if scene.engine else None
    if cycle is None:
        return 1.0, np.zeros(throws)
    force = float(np.ptp(cycle.forces.radial_force_N)) / 2
    torque = np.ptp(cycle.torque.sections_Nm, axis=1) / 2
    return force, np.maximum(torque[:-1], torque[1:])
