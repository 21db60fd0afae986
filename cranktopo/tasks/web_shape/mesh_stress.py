"""Quantities read off the stresses of a throw on one mesh, smooth, and their derivatives by the nodes.

One adjoint solve per unit field and quantity, with the matrix that is factorised already, brings a derivative
by the stresses at the surface back to the nodes.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.side_by_side import side_by_side
from cranktopo.base.units import MPA_PER_GPA, density_tonne_per_mm3
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import Loads, WebLoads
from cranktopo.engine.judged_histories import histories_by_speed
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, swing_force
from cranktopo.numerics.tetrahedra.node_gradients import (
    centrifugal_slopes,
    mean_slopes,
    swing_slopes,
    work_slopes,
)
from cranktopo.numerics.tetrahedra.rigid_motions import section_slopes
from cranktopo.numerics.tetrahedra.superelement import Superelement
from cranktopo.numerics.tetrahedra.unit_stress import UnitStress
from cranktopo.tasks.throw_fatigue.needs import load_kinds
from cranktopo.tasks.throw_fatigue.safety_field import unit_loads
from cranktopo.tasks.throw_fatigue.stress_model import images_of
from cranktopo.tasks.throw_fea.condense import Lateral, bending_motion, torsion_motion
from cranktopo.tasks.throw_fea.turning_load import pull_slopes, turning_load
from cranktopo.tasks.throw_fea.unit_fields import (
    AGAINST_TORQUE,
    FieldKind,
    UnitField,
    loaded,
    support_spring,
    twisted,
)
from cranktopo.tasks.web_shape.judged_throw import judged_throw, largest_stress, safety_by_lsa

_SMOOTH = {"fatigue_safety": (safety_by_lsa, min), "stress": (largest_stress, max)}
"""Smooth value of each quantity, and which of two speeds decides it: a sum would count the other one too."""
_PUSH: dict[FieldKind, tuple[int, float]] = {"bending": (1, -1.0), "tangential": (0, 1.0)}
"""Axis and sign of the unit forces on the pin."""
_SIDEWAYS: tuple[FieldKind, ...] = ("side_moment", *AGAINST_TORQUE)
"""Symmetric loads that the mirror x -> -x turns around."""


class MeshStress:
    """Quantities over the load states of a scene, by name."""

    def __init__(self, scene: Scene, names: Collection[str], loads: Loads = "extremes") -> None:
        """Find the load states, which the scene must tell unless they are those of a web in its shaft."""
        enabled, kinds = load_kinds(scene, loads)
        self.scene, self.kinds = scene, kinds
        self.histories = histories_by_speed(scene, loads, enabled)
        self._near_alone = isinstance(loads, WebLoads)
        self.names = tuple(name for name in _SMOOTH if name in names)

    def extra_loads(self, lateral: Lateral) -> tuple[FieldKind, ...]:
        """Return the further loads of a symmetric condensation with that symmetry in x, in their order."""
        held: dict[Lateral, tuple[FieldKind, ...]] = {"even": ("centrifugal",), "odd": AGAINST_TORQUE}
        return tuple(
            kind for kind in held.get(lateral, (*AGAINST_TORQUE, "centrifugal")) if kind in self.kinds
        )

    def responses(
        self,
        model: Elasticity,
        scene: Scene,
        bend: Superelement,
        twist: Superelement,
        side: Superelement | None = None,
        *,
        carried: Scene,
    ) -> dict[str, tuple[float, float, Array, Array]]:
        """Return each quantity on a mesh, by symmetric and antisymmetric condensation.

        Args:
            carried: the throw with what is fastened to its webs.
            side: the symmetric condensation that is odd in x, where the tangential force acts on a model of
                one side of x = 0.

        Returns:
            Its extreme value; a smooth one, beside it by a factor that hardly changes; the derivatives of the
            latter by the nodes, (3, nodes), and by `pull_totals`.
        """
        blocks: dict[FieldKind, Superelement] = dict.fromkeys(self.kinds, bend)
        blocks |= {"torsion": twist, **dict.fromkeys(_SIDEWAYS, side or bend)}
        pushed = [kind for kind in self.kinds if blocks[kind] is bend]
        by_kind = {**loaded(bend, self.scene, pushed), "torsion": twisted(twist, self.scene)}
        by_kind |= (
            loaded(side, self.scene, [kind for kind in self.kinds if kind in _SIDEWAYS]) if side else {}
        )
        fields = [by_kind[kind] for kind in self.kinds]
        moved = np.stack([field.displacement_mm for field in fields])
        mirrored = bend.parts == 2
        planes = [(2, 0.0), (2, scene.pitch_mm / 2)] + ([(0, 0.0)] if mirrored else [])
        found = UnitStress(model, moved, self._elastic, tuple(planes))
        images = [i for i in images_of(fields, mirrored) if not (self._near_alone and i.flip_z)]
        judged = [
            judged_throw(
                scene,
                found.surface,
                found.stress,
                [unit_loads(one, self.kinds) * image.signs for one in of_speed for image in images],
            )
            for of_speed in self.histories
        ]
        responses_by_name = {}
        for name in self.names:
            value, deciding = _SMOOTH[name]
            smooth = deciding((value(self.scene, one) for one in judged), key=lambda one: one.extreme)
            forces, gradients = found.adjoint(smooth.adjoint)
            through, by_totals = self._through_fields(model, blocks, fields, forces, carried)
            responses_by_name[name] = smooth.extreme, smooth.value, gradients + through, by_totals
        return responses_by_name

    @property
    def _elastic(self) -> tuple[float, float]:
        return self.scene.material.E_GPa * MPA_PER_GPA, self.scene.material.poisson

    def _through_fields(
        self,
        model: Elasticity,
        blocks: Mapping[FieldKind, Superelement],
        fields: list[UnitField],
        forces: Array,
        carried: Scene,
    ) -> tuple[Array, Array]:
        """Return the derivatives through all fields, whose adjoints are `forces`.

        By the nodes, (3, nodes), and by `pull_totals`.
        """
        pairs = list(zip(fields, forces, strict=True))

        def through(torsion: bool) -> tuple[Array, Array]:
            slopes, by_totals = np.zeros(model.nodes_mm.shape), np.zeros(4)
            for field, force in pairs:
                if (field.kind == "torsion") == torsion:
                    found = self._through_field(model, blocks[field.kind], field, force, carried)
                    slopes, by_totals = slopes + found[0], by_totals + found[1]
            return slopes, by_totals

        (one, _), (other, by_totals) = side_by_side(lambda: through(True), lambda: through(False))
        return one + other, by_totals

    def _through_field(
        self, model: Elasticity, block: Superelement, field: UnitField, force: Array, carried: Scene
    ) -> tuple[Array, Array]:
        """Return the derivatives through a field whose adjoint is `force`, by nodes and `pull_totals`."""
        scene, kind = self.scene, field.kind
        count = len(block.motions)
        units = block.displacement[:, :count]
        section = block.parts * units.T @ force
        if kind == "torsion":
            spring = support_spring(scene, scene.supports.torsion)
            motion = torsion_motion(block, scene.supports.torsion, spring, section)
        else:
            spring = support_spring(scene, scene.supports.bending)
            turning = kind not in AGAINST_TORQUE
            motion = bending_motion(block, section, scene.supports.bending, spring, turning=turning)
        adjoint = block.solve(force[:, None])[:, 0] + units @ motion
        moved, load, by_totals = field.displacement_mm, np.zeros(len(adjoint)), np.zeros(4)
        gradients = -work_slopes(model, *self._elastic, moved, adjoint)
        if kind in _PUSH:
            axis, sign = _PUSH[kind]
            gradients += sign * mean_slopes(model, axis, scene.web_z_mm[1], adjoint) / (2 * block.parts)
        if kind == "centrifugal":
            density = density_tonne_per_mm3(scene.material.density_kg_m3)
            lateral: Lateral = "even" if block.parts == 2 else "none"
            load = turning_load(model, carried, "symmetric", lateral)
            of_pull, by_totals = pull_slopes(model, carried, lateral, adjoint)
            gradients += centrifugal_slopes(model, density, adjoint) + of_pull
        if kind == "swing":
            models = 2 * block.parts
            load = swing_force(model) / models
            gradients += swing_slopes(model, adjoint) / models
        gradients += section_slopes(model, load - model.stiffness @ moved, adjoint)
        gradients += section_slopes(model, force - model.stiffness @ adjoint, moved)
        return gradients, by_totals
