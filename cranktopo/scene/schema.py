"""The scene: everything a user writes about one crank throw, validated and immutable."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files
from typing import Any, Literal

from pydantic import Field, model_validator

from cranktopo.errors import CranktopoError, invalid, suggest
from cranktopo.scene.base import Fraction, NonNegative, Positive, SceneTable
from cranktopo.scene.engine import Engine
from cranktopo.scene.fatigue_settings import Fatigue
from cranktopo.scene.geometry import Envelope, Throw, Web
from cranktopo.scene.supports import Supports

EffectState = Literal["auto", "on", "off"]
FkmGroup = Literal[
    "Steel",
    "Forg_Steel",
    "CaseHard_Steel",
    "Stainless_Steel",
    "GS",
    "GJS",
    "GJM",
    "GJL",
    "Al_wrought",
    "Al_cast",
]
"""Material groups of the FKM guideline."""
Process = Literal["free", "forged", "cast"]
"""How the web is made; forged and cast ones come from a die that parts in the plane x = 0."""


@cache
def material_library() -> dict[str, dict[str, Any]]:
    """The material library shipped with the package, by name."""
    return tomllib.loads((files("cranktopo.scene") / "materials.toml").read_text(encoding="utf-8"))


class Material(SceneTable):
    """Linear elastic material; a known `name` fills in every value that is not given."""

    name: str = "custom"
    E_GPa: Positive
    poisson: float = Field(ge=0, lt=0.5)
    density_kg_m3: Positive
    yield_MPa: Positive | None = None
    ultimate_MPa: Positive | None = None
    fatigue_tension_MPa: Positive | None = None
    fatigue_bending_MPa: Positive | None = None
    fkm_group: FkmGroup = "Steel"
    source: str = ""

    @model_validator(mode="before")
    @classmethod
    def _from_library(cls, data: Any) -> Any:
        if not isinstance(data, dict) or "name" not in data:
            return data
        entry = material_library().get(data["name"])
        if entry is None and not {"E_GPa", "poisson", "density_kg_m3"} <= data.keys():
            names = list(material_library())
            raise invalid(
                "material.name",
                data["name"],
                "not in the library, and E_GPa, poisson, density_kg_m3 are not all given",
                suggest(str(data["name"]), names),
            )
        return {**(entry or {}), **data}


class Effects(SceneTable):
    """State of each effect, and the relative change below which `auto` leaves an effect out."""

    threshold: float = Field(default=0.02, gt=0, lt=1)
    bending: EffectState = "auto"
    torsion: EffectState = "auto"
    tangential: EffectState = "auto"
    reciprocating_inertia: EffectState = "auto"
    rotating_rod_mass: EffectState = "auto"
    centrifugal: EffectState = "auto"
    bearing_compliance: EffectState = "auto"
    fillets: EffectState = "auto"
    bores: EffectState = "auto"
    lateral_symmetry: EffectState = "auto"
    manufacturing_constraint: EffectState = "auto"
    fatigue: EffectState = "auto"


class Weights(SceneTable):
    """Weight of each load case in the objective."""

    bending: NonNegative = 0.5
    torsion: NonNegative = 0.5
    tangential: NonNegative = 0.5
    centrifugal: NonNegative = 0.0


class Optimise(SceneTable):
    """Settings of the density optimisation."""

    volume_fraction: Fraction = 0.3
    resolution_mm: Positive = 1.5
    filter_radius_mm: Positive | None = None
    max_iterations: int = Field(default=150, ge=1, le=10000)
    weights: Weights = Weights()
    process: Process = "free"


class Published(SceneTable):
    """Values printed for this variant elsewhere, to be shown beside the computed ones as ratios only."""

    source: str
    mass_kg: Positive
    torsional_stiffness_kNm_per_rad: Positive


class Scene(SceneTable):
    """One throw, its loads, its design space and the settings of each stage."""

    schema_version: Literal[1] = 1
    name: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$")
    description: str = ""
    throw: Throw
    web: Web
    material: Material
    supports: Supports = Supports()
    engine: Engine | None = None
    envelope: Envelope | None = None
    effects: Effects = Effects()
    optimise: Optimise = Optimise()
    fatigue: Fatigue = Fatigue()
    published: Published | None = None

    def with_optimise(self, **changes: object) -> Scene:
        """The scene with other settings of `[optimise]`.

        Args:
            changes: by name; None keeps the scene's own.

        Raises:
            ValidationError: an unknown setting, or a value outside its range.
        """
        given = {key: value for key, value in changes.items() if value is not None}
        settings = Optimise.model_validate({**self.optimise.model_dump(), **given})
        return self.model_copy(update={"optimise": settings})

    @property
    def pitch_mm(self) -> float:
        """Distance between neighbouring mid-main-journal planes, mm."""
        return self.throw.main_journal.length_mm + self.throw.crankpin.length_mm + 2 * self.web.thickness_mm

    @property
    def web_z_mm(self) -> tuple[float, float]:
        """Axial range (journal face, pin face) of the web of the half throw, mm."""
        start = self.throw.main_journal.length_mm / 2
        return start, start + self.web.thickness_mm

    @property
    def shaft_angles_deg(self) -> tuple[float, ...]:
        """Angle of every throw of the shaft about the crank axis, deg, cylinder 1 first and at 0.

        Raises:
            CranktopoError: no engine, so nothing says how many throws the shaft has.
        """
        if self.engine is None:
            raise CranktopoError(
                f"{self.name}: [engine] is missing: the whole shaft needs its cylinders and firing order.",
                hint="Add [engine] with bore_mm, rod_length_mm, speed_rpm, cylinders and firing_order.",
            )
        return self.engine.throw_angles_deg
