"""What a feature sees of the scene that holds it; the scene is built from the features, so it comes later."""

from __future__ import annotations

from collections.abc import Hashable
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from cranktopo.throw.geometry import ThrowTable


class ThrowView(Hashable, Protocol):
    """The throw around a web: its journals, the web table (`WebTable`) and where its faces lie."""

    @property
    def throw(self) -> ThrowTable:
        """Crank radius and journals."""

    @property
    def web(self) -> Any:
        """The web, a `WebTable`: it holds features and so cannot be named here."""

    @property
    def web_z_mm(self) -> tuple[float, float]:
        """Heights of the web's journal face and pin face."""

    @property
    def pitch_mm(self) -> float:
        """Distance between the middles of the main journals."""
