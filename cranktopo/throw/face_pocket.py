"""What pockets from a web face have in common: their axis is parallel to the crank axis."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, Self

from typing_extensions import override

from cranktopo.base.table import Place
from cranktopo.throw.feature import Feature
from cranktopo.throw.hole import check_cut

if TYPE_CHECKING:
    from cranktopo.throw.throw_view import ThrowView


class FacePocket(Feature):
    """Pocket with its axis parallel to the crank axis; a kind names its shapes, faces and sizes."""

    shape: str
    face: Literal["journal", "pin", "through"]
    x_mm: Place = 0.0
    """Centre across the throw, from the crank axis."""

    @override
    def check_in_web(self, scene: ThrowView, key: str) -> None:
        for body in self.bodies(scene, key):
            check_cut(scene, body)

    @override
    def mirrored(self) -> Self:
        return self.model_copy(update={"x_mm": -self.x_mm + 0.0})
