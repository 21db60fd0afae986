"""What a feature sees of the scene that holds it; scene and throw come later, being built from features."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any, Protocol

from cranktopo.throw.fillet import FilletSection


class JournalView(Protocol):
    """A main journal or crankpin."""

    @property
    def outer_diameter_mm(self) -> float:
        """Outer diameter."""

    @property
    def bore_diameter_mm(self) -> float:
        """Diameter of the axial bore; 0 = solid."""

    @property
    def length_mm(self) -> float:
        """Full length between the webs."""

    @property
    def radius_mm(self) -> float:
        """Outer radius."""

    @property
    def bore_radius_mm(self) -> float:
        """Radius of the bore; 0 = solid."""

    @property
    def fillet_mm(self) -> float:
        """Radius of its fillets on the web's face; 0 = sharp."""

    @property
    def fillet(self) -> FilletSection:
        """Section of its fillets."""


class JournalsView(Hashable, Protocol):
    """Crank radius, journals and drillings."""

    @property
    def radius_mm(self) -> float:
        """Distance of the crankpin's axis from the crank axis."""

    @property
    def main_journal(self) -> JournalView:
        """The main journal."""

    @property
    def crankpin(self) -> JournalView:
        """The crankpin."""

    @property
    def journals(self) -> tuple[tuple[JournalView, float], tuple[JournalView, float]]:
        """Both, each with the place of its axis along the throw."""

    @property
    def drilling(self) -> tuple[Any, ...]:
        """The oil drillings, each a feature."""


class ThrowView(Hashable, Protocol):
    """The throw around a web: its journals, the web table (`WebTable`) and where its faces lie."""

    @property
    def throw(self) -> JournalsView:
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
