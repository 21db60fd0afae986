"""Scene tables of the material, and of what its fatigue strength depends on."""

from __future__ import annotations

import re
import tomllib
from functools import cache
from importlib.resources import files
from typing import Any, Literal, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from cranktopo.base.table import (
    SHOWN,
    UNLESS_IN_LIBRARY,
    Length,
    SceneTable,
    Strength,
    TurningSpeed,
    filled_in,
    is_unset,
)
from cranktopo.design.hardening import CaseHardening, Fillet, Hardening

_FkmGroup = Literal[
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


LIBRARY_STRENGTHS = ("yield_MPa", "fatigue_tension_MPa", "fatigue_bending_MPa")
"""Keys of the library that follow a tensile strength which the design gives."""
_SECTION, _THICKER = "sections_to_mm", "thicker"
_OF_SECTIONS = r"\{(.*?)\}"
"""Part of a source on sections, which is of tensile and yield strength alone."""
_OWN_WORDS = {"ultimate_MPa": "tensile", "yield_MPa": "yield"}


@cache
def _entries() -> dict[str, dict[str, Any]]:
    return tomllib.loads((files("cranktopo.design") / "materials.toml").read_text(encoding="utf-8"))


@cache
def material_library() -> dict[str, dict[str, Any]]:
    """Return the material library shipped with the package, by name."""
    return {
        name: {key: value for key, value in entry.items() if key not in (_SECTION, _THICKER)}
        | {"source": re.sub(_OF_SECTIONS, r"\1", entry["source"])}
        for name, entry in _entries().items()
    }


def library_section_mm(name: str) -> float | None:
    """Return the thickest section that the library's strengths of a material hold for; None where unknown."""
    return _entries().get(name, {}).get(_SECTION)


def thicker_MPa(name: str, section_mm: float) -> tuple[float, float] | None:
    """Return the tensile and yield strength that a standard asks for in a section; None where unknown."""
    rows = _entries().get(name, {}).get(_THICKER, ())
    return next(((Rm, Re) for to_mm, Rm, Re in rows if section_mm <= to_mm), None)


class Material(SceneTable):
    """Linear elastic material; a known `name` fills in every value that is not given."""

    name: str = Field(default="custom", examples=["31CrMoV9"], json_schema_extra=SHOWN)
    """A name of the library fills in every key that is not given; any other name needs own values. Beside an
    own tensile strength the other strengths of the library are taken in proportion."""
    E_GPa: float = Field(ge=0.1, le=2000, examples=[210.0], json_schema_extra=UNLESS_IN_LIBRARY)
    """Young's modulus."""
    poisson: float = Field(ge=0, le=0.49, examples=[0.3], json_schema_extra=UNLESS_IN_LIBRARY)
    """Poisson's ratio."""
    density_kg_m3: float = Field(ge=10, le=30000, examples=[7850.0], json_schema_extra=UNLESS_IN_LIBRARY)
    """Density."""
    yield_MPa: Strength | None = Field(default=None, examples=[900.0])
    """Yield strength."""
    ultimate_MPa: Strength | None = Field(default=None, examples=[1100.0])
    """Tensile strength."""
    fatigue_tension_MPa: Strength | None = Field(default=None, examples=[495.0])
    """Fatigue strength (amplitude) of a polished specimen in alternating tension."""
    fatigue_bending_MPa: Strength | None = Field(default=None, examples=[525.0])
    """Fatigue strength (amplitude) of a polished specimen in alternating bending."""
    fatigue_torsion_MPa: Strength | None = Field(default=None, examples=[303.0], exclude_if=is_unset)
    """Fatigue strength (amplitude) of a polished round specimen in alternating torsion, for `fatigue --method
    findley` and `dang_van`; without it that in bending over the square root of 3."""
    fkm_group: _FkmGroup = "Steel"
    """Material group of the FKM guideline, for `fatigue --method fkm`."""
    heat_treatment: str = Field(
        default="", max_length=200, examples=["quenched and tempered"], exclude_if=is_unset
    )
    """Heat treatment of the forging, for the dossier of `fatigue --method m53`."""
    source: str = ""
    """Origin of the values."""

    @model_validator(mode="before")
    @classmethod
    def _from_library(cls, data: Any) -> Any:
        filled = filled_in(data, material_library(), frozenset({"E_GPa", "poisson", "density_kg_m3"}))
        return _in_proportion(data, filled)

    @model_validator(mode="after")
    def _below_ultimate(self) -> Self:
        for key in LIBRARY_STRENGTHS:
            value = getattr(self, key)
            if value is not None and self.ultimate_MPa is not None and value > self.ultimate_MPa:
                why = f"{key} = {value:g} is above ultimate_MPa = {self.ultimate_MPa:g}"
                raise PydanticCustomError("statement", "{why}", {"why": why, "hint": "Correct one of them."})
        return self


def _in_proportion(data: Any, filled: Any) -> Any:
    """Return a material with the library's strengths scaled to the tensile strength that is given."""
    if not isinstance(data, dict) or not isinstance(data.get("ultimate_MPa"), int | float):
        return filled
    entry = material_library().get(str(data.get("name")), {})
    usual = entry.get("ultimate_MPa")
    if not usual or data["ultimate_MPa"] == usual:
        return filled
    share = data["ultimate_MPa"] / usual
    scaled = {key: entry[key] * share for key in LIBRARY_STRENGTHS if key in entry and key not in data}
    return {**filled, **scaled, "source": data.get("source", _source_of_rest(data))}


def _source_of_rest(data: dict[str, Any]) -> str:
    """Return the origin of a material with own strengths: of sections nothing where both are its own."""
    own = [word for key, word in _OWN_WORDS.items() if key in data]
    source = re.sub(_OF_SECTIONS, "" if len(own) == 2 else r"\1", _entries()[data["name"]]["source"])
    return f"{' and '.join(own)} strength of the design; for the rest: {source}"


M53Factors = Literal["lower", "polynomials", "elements"]


class Scatter(SceneTable):
    """Scatter of what the fatigue safety follows from, each by its standard deviation.

    `fatigue` then tells the probability of failure beside the safety. The given loads and radii are means;
    the mean strength is that at a survival factor of one.
    """

    strength_percent: float = Field(default=8.0, ge=0.1, le=50)
    """Of the fatigue strength, of its mean: 8 % is behind the reliability factors of Shigley's Mechanical
    Engineering Design, 0.753 at a survival of 99.9 %."""
    load_percent: float = Field(default=0.0, ge=0, le=50, examples=[5.0])
    """Of the loads, which rise and fall together, of their mean."""
    fillet_radius_mm: float = Field(default=0.0, ge=0, le=50, examples=[0.1])
    """Of the radii of the fillets."""


class SpectrumStep(SceneTable):
    """A speed that the engine runs at for a part of its time."""

    rpm: TurningSpeed = Field(examples=[2000.0])
    """Speed of the crank."""
    share: float = Field(gt=0, le=1e6, examples=[0.6], allow_inf_nan=False)
    """Time at it, in hours, percent, or any other measure that all steps have."""


class Spectrum(SceneTable):
    """Speeds over the life of the engine, and the S-N line that sums their damage.

    `fatigue` then tells the life in hours beside the safety. Defaults: FKM guideline, chapter 4.4, steel, not
    welded; below the fatigue limit the slope is 2 k - 1 (Haibach), where some cycle exceeds it.
    """

    step: tuple[SpectrumStep, ...] = Field(min_length=1, max_length=200)
    """Speeds with their parts of the time."""
    slope: float = Field(default=5.0, ge=1, le=30)
    """Exponent k of the S-N line: life falls by the stress to this power."""
    knee_cycles: float = Field(default=1e6, ge=1e3, le=1e9)
    """Cycles that the fatigue limit is endured for."""
    permitted_damage: float = Field(default=0.3, ge=0.01, le=2)
    """Sum of damage at the end of life: 0.3 for steel by the guideline, 1 by Miner."""


class Fatigue(SceneTable):
    """Surface, size and rule factors of the fatigue methods.

    Defaults: size and survival factor and specimen of J. Voparil, Brno University of Technology, 2011; ground
    fillets; free forging and trunk piston engine of IACS UR M53.
    """

    surface_treatment_factor: float = Field(default=1.0, ge=0.5, le=3.0)
    """Strength of rolled, nitrided or hardened fillets over untreated ones, by tests or a standard."""
    surface_treatment_source: str = Field(
        default="", max_length=500, examples=["rolled, component tests of the forge, report 12/2025"]
    )
    """The treatment and where its factor comes from; shown beside every safety that holds it."""
    size_factor: float = Field(default=0.89, ge=0.01, le=1.0)
    """Strength of the part over that of the specimen for its size."""
    survival_factor: float = Field(default=0.75, ge=0.01, le=1.0)
    """Strength at the wanted probability of survival over the mean strength."""
    specimen_diameter_mm: Length = 7.5
    """Diameter of the specimens of the fatigue strengths."""
    roughness_um: float = Field(default=6.3, ge=0.01, le=1000)
    """Roughness Rz of the fillets."""
    process_factor: float = Field(default=1.0, ge=0.1, le=1.5)
    """Factor K of IACS UR M53 for the way of forging: 1.0 free forged, by default, as it asks least of the
    forge; 1.05 with continuous grain flow or drop forged, 0.93 cast."""
    additional_stress_MPa: float = Field(default=10.0, ge=0, le=1e4)
    """Additional bending stress of IACS UR M53: 10 for trunk piston engines."""
    m53_factors: M53Factors = "lower"
    """Concentration factors that govern by IACS UR M53, at fillets and outlets of oil bores: those of its
    polynomials, those of elements (Appendices III and VI), or those with the lower acceptability where the
    polynomials are valid."""
    hardening: Hardening | None = Field(default=None, exclude_if=is_unset)
    """Hardened, nitrided or rolled fillets by hardness and residual stress over depth."""
    journal_hardening: CaseHardening | None = Field(default=None, exclude_if=is_unset)
    """The fillets of the main journals where their treatment differs from `[fatigue.hardening]`."""

    spectrum: Spectrum | None = Field(default=None, exclude_if=is_unset)
    """Speeds over the life of the engine: the life in hours beside the safety (`lsa`, `fkm`)."""
    scatter: Scatter | None = Field(default=None, exclude_if=is_unset)
    """Scatter of strength, load and fillets: the probability of failure beside the safety (`lsa`)."""

    def hardening_at(self, fillet: Fillet) -> CaseHardening | None:
        """Return how a fillet is hardened over its depth; None where it is not."""
        if fillet == "journal" and self.journal_hardening is not None:
            return self.journal_hardening
        hardening = self.hardening
        return hardening if hardening is not None and hardening.fillets in ("both", fillet) else None

    @property
    def hardened(self) -> dict[Fillet, CaseHardening]:
        """Treatments over depth by fillet."""
        fillets: tuple[Fillet, ...] = ("pin", "journal")
        found = {fillet: self.hardening_at(fillet) for fillet in fillets}
        return {fillet: one for fillet, one in found.items() if one is not None}

    @property
    def factor_off_fillets(self) -> float:
        """The factor on the strength off the fillets, which no treatment of the fillets raises."""
        return min(self.surface_treatment_factor, 1.0)

    @property
    def treatment(self) -> str:
        """The surface treatment with its source in words; empty where there is none."""
        if self.hardened:
            alike = len(self.hardened) == 2 and self.journal_hardening is None
            words_by_fillet = {fillet: one.words for fillet, one in self.hardened.items()}
            each = (
                words_by_fillet["pin"]
                if alike
                else "; ".join(f"{key} fillets {one}" for key, one in words_by_fillet.items())
            )
            return f"strength of the fillets by hardness and residual stress over depth: {each}"
        factor = self.surface_treatment_factor
        if factor == 1.0:
            return ""
        source = self.surface_treatment_source or "NO SOURCE; name it in fatigue.surface_treatment_source"
        return f"strength of the fillets times {factor:g} for their surface treatment: {source}"
