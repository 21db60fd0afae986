"""Webs of one layout on body-fitted meshes, for a search: a mesh is moved with the web until it suffers."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from cranktopo.errors import CranktopoError
from cranktopo.remodel.family import Layout
from cranktopo.remodel.manufacturing_limits import ManufacturingLimits
from cranktopo.remodel.parametric_web import ParametricWeb
from cranktopo.scene import Scene
from cranktopo.shape.mesh_model import MeshModel, MeshResponses

Array = NDArray[np.float64]
_LEAST_QUALITY = 0.3
"""Least Jacobian of an element over its own in the new mesh, below which a new one is made."""
_ON_THE_WAY = (0.5, 0.25)
"""Parts of a step at which a mesh is replaced that folds on the whole of it."""


def rules_web(layout: Layout, scene: Scene, limits: ManufacturingLimits) -> ParametricWeb:
    """A web of the layout on no cells, for its bounds and manufacturing constraints."""
    return ParametricWeb(layout, scene, limits, (np.zeros(0),) * 3)


class MeshedWebs:
    """Webs on meshes of one element size.

    Attributes:
        scene, limits: the throw and what can be made.
        meshes: how many were made.
    """

    def __init__(
        self,
        scene: Scene,
        limits: ManufacturingLimits,
        element_size_mm: float,
        fillet_fraction: float | None = None,
        shares: Mapping[str, float] | None = None,
    ) -> None:
        """Say how webs are meshed; nothing is meshed yet.

        Args:
            fillet_fraction: element size on a fillet over its radius; with it the fatigue safety is found.
            shares: factors by quantity that bring a coarse mesh to the numbers of a finer one.
        """
        self.scene, self.limits, self.meshes = scene, limits, 0
        self._size, self._fraction, self._shares = element_size_mm, fillet_fraction, dict(shares or {})
        self._made: tuple[Layout, MeshModel] | None = None

    def web(self, layout: Layout) -> ParametricWeb:
        """A web of the layout, for its bounds and manufacturing constraints."""
        return rules_web(layout, self.scene, self.limits)

    def responses(
        self, web: ParametricWeb, values: Array, quantities: Collection[str] | None = None
    ) -> MeshResponses:
        """Quantities of a web with these values, and their gradients.

        Where a suffering mesh is replaced, the numbers go on from its own, so that a search sees no jump.

        Raises:
            CranktopoError: no sound web, no valid mesh, or a failed solve.
        """
        old = self._moved(web.layout, values, quantities)
        if old is None and self._renewed_on_the_way(web, values, quantities):
            old = self._moved(web.layout, values, quantities)
        if old is not None and old.quality >= _LEAST_QUALITY:
            return old.scaled(self._shares)
        return self._renewed(web, values, quantities, old)

    def _renewed_on_the_way(
        self, web: ParametricWeb, values: Array, quantities: Collection[str] | None
    ) -> bool:
        """Replace a mesh that folds before it reaches a web by one for a web between, if there is one."""
        if self._made is None or self._made[0] != web.layout:
            return False
        start = self._made[1].moved.values
        for share in _ON_THE_WAY:
            between = start + share * (values - start)
            old = self._moved(web.layout, between, quantities)
            if old is not None:
                self._renewed(web, between, quantities, old)
                return True
        return False

    def _renewed(
        self,
        web: ParametricWeb,
        values: Array,
        quantities: Collection[str] | None,
        old: MeshResponses | None,
    ) -> MeshResponses:
        """By a new mesh, as a share of the old one's numbers; by the old one where there is no new one."""
        try:
            model = MeshModel(self.scene, web.layout, values, self._size, self._fraction)
            new = model.responses(values, quantities)
        except CranktopoError:
            if old is None:
                raise
            return old.scaled(self._shares)
        self._made, self.meshes = (web.layout, model), self.meshes + 1
        if old is not None:
            for name, value in old.values.items():
                self._shares[name] = self._shares.get(name, 1.0) * value / new.values[name]
        return new.scaled(self._shares)

    def anchored(self, web: ParametricWeb, values: Array, truth: Mapping[str, float]) -> MeshResponses:
        """Quantities of a web that is known better: from here on they are told as shares of the truth.

        Args:
            truth: its quantities by a finer evaluation.
        """
        found = self.responses(web, values)
        both = found.values.keys() & truth.keys()
        shares = {name: truth[name] / found.values[name] for name in both if found.values[name]}
        self._shares |= {name: self._shares.get(name, 1.0) * share for name, share in shares.items()}
        return found.scaled(shares)

    def _moved(
        self, layout: Layout, values: Array, quantities: Collection[str] | None
    ) -> MeshResponses | None:
        """By the mesh that is there; None where there is none of this layout, or it folds."""
        if self._made is None or self._made[0] != layout:
            return None
        try:
            return self._made[1].responses(values, quantities)
        except CranktopoError:
            return None
