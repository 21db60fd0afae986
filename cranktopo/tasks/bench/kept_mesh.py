"""The mesh of the web that settled last, which follows the next ones as far as it can."""

from __future__ import annotations

from cranktopo.base.side_by_side import LazyFuture
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow, follow_throw
from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION, mesh_for_stress
from cranktopo.tasks.throw_fea.targets import Target


class KeptMesh:
    """The last mesh for stresses that was made anew."""

    def __init__(self) -> None:
        self._last: MeshedThrow | None = None

    def of(self, target: Target) -> MeshedThrow:
        """Return a mesh of a target without a file for its stresses: the last one moved, else a new one.

        Raises:
            CranktopoError: a fillet of radius 0, impossible geometry, or a failed mesh.
        """
        followed = self._last and follow_throw(self._last, target.scene)
        if followed is None:
            self._last = None  # its memory is for the next one
            followed, _ = mesh_for_stress(target, RULE_FRACTION, to_follow=True)
            self._last = followed
            if followed.followed:
                LazyFuture(followed.followed.mesh.get_ready).begin()  # beside the solves of this one
        return followed
