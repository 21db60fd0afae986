"""The whole crankshaft of a design: stiffness end to end, per throw, and torsional natural frequencies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cranktopo.errors import CranktopoError
from cranktopo.evaluate.chain import (
    Bearings,
    ShaftStiffness,
    shaft_matrix,
    shaft_stiffness,
    throw_matrix,
)
from cranktopo.evaluate.elasticity import assemble
from cranktopo.evaluate.evaluation import SCHEMA_VERSION, default_element_size_mm
from cranktopo.evaluate.torsional import DiskModel, disk_model
from cranktopo.loads.bearings import bearing_spring_N_per_mm
from cranktopo.remodel.meshing import mesh_throw
from cranktopo.scene import Scene
from cranktopo.units import MPA_PER_GPA, density_kg_per_mm3


@dataclass(frozen=True)
class ShaftEvaluation:
    """A whole crankshaft.

    Attributes:
        design: name of the scene.
        angles_deg: angle of each throw.
        bearings: how its sections are supported.
        mass_kg: of all throws.
        stiffness: end to end and per throw.
        disks: its model as disks and springs.
    """

    design: str
    angles_deg: tuple[float, ...]
    bearings: Bearings
    mass_kg: float
    stiffness: ShaftStiffness
    disks: DiskModel

    def as_json(self) -> dict[str, Any]:
        """The object that `shaft --json` prints."""
        return {
            "schema_version": SCHEMA_VERSION,
            "design": self.design,
            "throw_angles_deg": list(self.angles_deg),
            "bearings": self.bearings,
            "mass_kg": self.mass_kg,
            "torsion": {
                "end_to_end_Nm_per_rad": self.stiffness.end_to_end_Nm_per_rad,
                "throws_Nm_per_rad": list(self.stiffness.throws_Nm_per_rad),
            },
            "natural_frequencies_Hz": list(self.disks.natural_frequencies_Hz()),
            "opentorsion": self.disks.as_opentorsion(),
        }


def evaluate_shaft(scene: Scene, bearings: Bearings, element_size_mm: float | None = None) -> ShaftEvaluation:
    """Chain the condensed throws of a design by its firing order.

    Args:
        scene: design with engine.firing_order.
        bearings: support of every mid-journal section.
        element_size_mm: general element size; by default as `default_element_size_mm`.

    Raises:
        CranktopoError: no firing order, no bearing spring for "spring", or a failed solve.
    """
    if scene.engine is None or not scene.engine.firing_order:
        raise CranktopoError(
            f"{scene.name}: engine.firing_order is missing.",
            hint="Add cylinders = 4 and firing_order = [1, 3, 4, 2] to [engine].",
        )
    spring = bearing_spring_N_per_mm(scene)
    if bearings == "spring" and spring is None:
        raise CranktopoError(
            "supports.bearing_spring_N_per_mm is missing.", hint="Give it in N/mm, or choose rigid bearings."
        )
    part = mesh_throw(scene, element_size_mm or default_element_size_mm(scene))
    model = assemble(part.mesh, scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson)
    throw = throw_matrix(model, scene, part.mesh.mirrored)
    angles = scene.engine.throw_angles_deg
    stiffness = shaft_stiffness(shaft_matrix(throw, angles), bearings, spring or 0.0)
    density = 2 * density_kg_per_mm3(scene.material.density_kg_m3)
    disks = disk_model(scene, density * part.half.inertia_z_mm5, stiffness.throws_Nm_per_rad)
    mass = len(angles) * density * part.half.volume_mm3
    return ShaftEvaluation(scene.name, angles, bearings, mass, stiffness, disks)
