"""The reduced model of the whole shaft as one file of named arrays, which tells what each of them is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.files import as_path, write_npz
from cranktopo.base.formats import ARRAYS
from cranktopo.base.frames import about_z_deg
from cranktopo.base.notes import note
from cranktopo.bodies.crank_ends import main_journal_places_mm
from cranktopo.design.crank_throws import carried
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import ShaftTable
from cranktopo.engine.balance.crank import drawn_crank_mass
from cranktopo.engine.bearings import bearing_spring_N_per_mm, bearing_tilt_spring_Nmm_per_rad
from cranktopo.runs.destination import check_file
from cranktopo.tasks.dynamics.assembled import AssembledShaft, assembled
from cranktopo.tasks.dynamics.moving_shaft import MovingShaft
from cranktopo.tasks.dynamics.stage import check_dynamics, dynamic_shaft
from cranktopo.tasks.dynamics.stress import moving_stress
from cranktopo.tasks.export.recovery import FilletRecovery, fillet_stress
from cranktopo.tasks.modes.carried import without_mass
from cranktopo.tasks.shaft.loaded_throw import LOADS
from cranktopo.tasks.shaft.stage import throw_targets
from cranktopo.tasks.throw_fatigue.shaft_stress import solve_shaft_stress
from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION, check_fillets
from cranktopo.tasks.throw_fea.targets import TargetLike, resolve_target

SCHEMA_VERSION = 1
_EQUATION = (
    "Free shaft without bearings in the frame that turns with it, mm, tonne, N, s, rad, MPa: "
    "mass q'' + (viscous + w gyroscopic) q' + (stiffness - w^2 softening) q = loads, "
    "w = rotation_about_z times the speed in rad/s; a steady vibration adds i loss to the stiffness. "
    "x, y are those of throw 1 (y toward its pin), z along the shaft toward the output, 0 in the middle of "
    "the first main journal."
)
_EXPLAINED = {
    "schema_version": "number of this form of the file",
    "design": "name of the design",
    "coordinate_name": "section (middle of a main journal), field, joint of an end or part that moves, (n,)",
    "coordinate_motion": "ux, uy, uz, rx, ry, rz; oval, saddle, shear: a section deforms in its plane, "
    "or along z as a saddle or as under a shear force; field: deformation of a throw, sections held, (n,)",
    "coordinate_unit": "of the coordinate q, (n,)",
    "coordinate_z_mm": "place along the shaft, (n,); of a field, the middle of its throw",
    "stiffness": "(n, n)",
    "mass": "(n, n); rods and pistons by their mean mass on the pins, in x and y alone",
    "gyroscopic": "force per velocity and per rad/s, (n, n), antisymmetric",
    "softening": "centrifugal less what rotation stiffens, per (rad/s)^2, (n, n)",
    "loss": "imaginary part of the stiffness in a steady vibration, (n, n)",
    "viscous": "force per velocity, (n, n)",
    "loss_factor": "of the material of the crank",
    "rotation_about_z": "1 where the shaft turns right-handed about z, else -1",
    "bearing_z_mm": "main bearings: places, (b,)",
    "bearing_coordinates": "rows of q that are ux, uy, rx, ry of the section in each bearing, (b, 4)",
    "bearing_stiffness_N_per_mm": "in x and y, (b,); inf: the design gives none, hold ux and uy",
    "bearing_tilt_stiffness_Nmm_per_rad": "about x and y, (b,)",
    "load_name": "unit loads of a throw, (5,): on its pin 1 N radial along its -y, tangential along its +x; "
    "aside: half of it on the near half of the pin, the opposite on the far one; centrifugal: of 1 rad/s",
    "loads": "unit loads of each throw over the coordinates, (throws, 5, n)",
    "crank_mass_kg": "of the drawn crank in closed form; mass has that of its mesh",
    "without_mass": "parts whose mass the design does not give: they count in torsion alone",
    "throw_angle_deg": "of each throw about z, right-handed, from throw 1, (throws,)",
    "throw_z_mm": "place of its near section, (throws,)",
    "throw_kind": "number K of its shape: throws of one shape have the same fillets, (throws,)",
    "throw_motion_T": "of throw T = 1, 2, ...: its unknowns in its own axes are this times q, (u, n)",
    "fillet_points_mm_K": "nodes on all fillets of shape K, from its near section in its axes, (p, 3)",
    "fillet_name_K": "pin or journal, (p,)",
    "fillet_web_K": "1: of the web nearer to the free end, 2: of the other, (p,)",
    "fillet_stress_MPa_K": "xx, yy, zz, xy, yz, zx in its axes per unit of its unknowns, (u, p, 6)",
}

Arrays = Mapping[str, NDArray[np.generic]]


def export_reduced(target: TargetLike, file: Path | str, fillet_fraction: float = RULE_FRACTION) -> str:
    """Write the reduced model of a whole crank to an .npz file; return what it holds in words.

    Args:
        target: a design with an engine, or a run.
        fillet_fraction: element size in a fillet over its radius.

    Raises:
        CranktopoError: another ending of the file, no engine, a throw that is not modelled, sharp fillets, a
            material without damping, or a failed solve.
    """
    path = as_path(file)
    check_file(path, "file", ARRAYS)
    resolved = resolve_target(target, fillets=True, whole=True, crank=True)
    scene, throws = resolved.scene, throw_targets(resolved)
    _ = scene.shaft_angles_deg  # refuses a scene without an engine before anything is solved
    check_dynamics(scene, "rigid")
    bearings = _bearings(scene)
    kinds = list(dict.fromkeys(throws))
    for one in kinds:
        check_fillets(one)
    stresses = {one.name: solve_shaft_stress(one, fillet_fraction) for one in kinds}
    bodies = {name: stress.body for name, stress in stresses.items()}
    moving = dynamic_shaft(throws, bodies, scene, "rigid", None).moving
    shaft = assembled(moving, scene)
    number = [kinds.index(one) for one in throws]
    note(f"{resolved.name}: stresses on the fillets by the coordinates of the shaft")
    fillets = [
        fillet_stress(moving_stress(stresses[one.name], moving.throws[number.index(k)], fillet_fraction))
        for k, one in enumerate(kinds)
    ]
    arrays = {**_matrices(shaft, moving, scene), **bearings, **_of_throws(shaft, fillets, number)}
    texts = [f"{name}: {words}" for name, words in _EXPLAINED.items()]
    write_npz(
        path,
        {
            "about": np.array("\n".join([_EQUATION, *texts])),
            "schema_version": np.array(SCHEMA_VERSION),
            "design": np.array(resolved.name),
            **arrays,
        },
        compressed=True,
    )
    nodes = sum(len(one.points_mm) for one in fillets)
    return f"{len(shaft.coordinates)} coordinates, stress at {nodes} nodes of fillets"


def _matrices(shaft: AssembledShaft, moving: MovingShaft, scene: Scene) -> Arrays:
    body, coordinates = shaft.damped.body, shaft.coordinates
    loads = [motion.T @ throw.loads for motion, throw in zip(shaft.own, moving.throws, strict=True)]
    return {
        "coordinate_name": np.array([one.name for one in coordinates]),
        "coordinate_motion": np.array([one.motion for one in coordinates]),
        "coordinate_unit": np.array([one.unit for one in coordinates]),
        "coordinate_z_mm": np.array([one.z_mm for one in coordinates]),
        "stiffness": body.stiffness,
        "mass": body.mass,
        "gyroscopic": 2 * body.coriolis,
        "softening": body.lateral - body.stiffening,
        "loss": shaft.damped.loss,
        "viscous": shaft.damped.viscous,
        "loss_factor": np.array(moving.loss_factor),
        "rotation_about_z": np.array(about_z_deg(1.0)),
        "load_name": np.array(LOADS),
        "loads": np.stack([one.T for one in loads]),
        "crank_mass_kg": np.array(drawn_crank_mass(scene).mass_kg),
        "without_mass": np.array(without_mass(scene.shaft or ShaftTable()), dtype=np.str_),
        "throw_angle_deg": np.array([about_z_deg(angle) for angle in moving.angles_deg]) + 0.0,
        "throw_z_mm": np.array(main_journal_places_mm(scene)[:-1]),
    }


def _bearings(scene: Scene) -> Arrays:
    sections, spring = list(carried(scene)), bearing_spring_N_per_mm(scene)
    tilt = bearing_tilt_spring_Nmm_per_rad(scene)
    across = np.array([0, 1, 3, 4])
    return {
        "bearing_z_mm": np.array(main_journal_places_mm(scene))[sections],
        "bearing_coordinates": 6 * np.array(sections)[:, None] + across,
        "bearing_stiffness_N_per_mm": np.full(len(sections), np.inf if spring is None else spring),
        "bearing_tilt_stiffness_Nmm_per_rad": np.full(len(sections), tilt),
    }


def _of_throws(shaft: AssembledShaft, fillets: Sequence[FilletRecovery], kinds: Sequence[int]) -> Arrays:
    found: dict[str, Array | NDArray[np.generic]] = {"throw_kind": np.array(kinds) + 1}
    for throw, motion in enumerate(shaft.own, start=1):
        found[f"throw_motion_{throw}"] = motion
    for kind, fillet in enumerate(fillets, start=1):
        found[f"fillet_points_mm_{kind}"] = fillet.points_mm
        found[f"fillet_name_{kind}"] = np.where(fillet.on_pin, "pin", "journal")
        found[f"fillet_web_{kind}"] = np.where(fillet.on_second, 2, 1)
        found[f"fillet_stress_MPa_{kind}"] = fillet.stress_MPa
    return found
