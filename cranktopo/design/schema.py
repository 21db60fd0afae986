"""The scene: everything a user writes about one crank throw, validated and immutable."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, ValidationError, create_model

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.base.table import (
    LIKE_WEB,
    SHOWN,
    Fraction,
    Length,
    SceneTable,
    Weight,
    WholeNumber,
    is_unset,
)
from cranktopo.design.balancer import BalancerPart
from cranktopo.design.bolt import BoltedJoint
from cranktopo.design.crank import Crank
from cranktopo.design.drawing import Drawing
from cranktopo.design.engine import Engine
from cranktopo.design.goal.limit import GoalTable
from cranktopo.design.load_kinds import LOAD_KINDS, LoadKeys
from cranktopo.design.material import Fatigue, Material
from cranktopo.design.messages import explain, register_root
from cranktopo.design.plain_bearings import PlainBearings
from cranktopo.design.published import Published
from cranktopo.design.rod import Rod
from cranktopo.design.shaft import ShaftTable, Supports
from cranktopo.design.shape import ShapeTable
from cranktopo.throw.drilling.table import Drilling
from cranktopo.throw.envelope import Envelope
from cranktopo.throw.feature import Feature
from cranktopo.throw.journal import Journal
from cranktopo.throw.outline import Web
from cranktopo.throw.raw_part.table import Forging


class ThrowTable(SceneTable):
    """Crank throw: radius and its two journals."""

    radius_mm: Length = Field(examples=[48.0])
    """Distance of the crankpin's axis from the crank axis: half the stroke."""
    main_journal: Journal
    """The main journal, centred on the crank axis."""
    crankpin: Journal
    """The crankpin, centred on the throw radius."""
    second_main_journal: Journal | None = None
    """The main journal beyond the second web where it differs from `main_journal`; half of it is this
    throw's."""
    second_main_journal_length_mm: Length | None = Field(default=None, examples=[44.0])
    """Full length of the main journal beyond the second web, half of which is this throw's; by default that
    of `main_journal`."""
    second_crankpin_length_mm: Length | None = Field(default=None, examples=[38.0])
    """Twice the length of the crankpin from the cylinder's axis to the second web; by default the axis is in
    its middle, and it is `crankpin.length_mm`."""
    mirrored_web: Literal["first", "second"] | None = Field(default=None, examples=["first"])
    """The web of a throw with two different ones that this throw has twice: the half beyond the crankpin is
    taken as its mirror image. Written by `--web` of the optimisers; changes nothing but what is assumed."""
    drilling: tuple[Drilling, ...] = Field(default=(), max_length=8)

    @property
    def journals(self) -> tuple[tuple[Journal, float], tuple[Journal, float]]:
        """Main journal and crankpin, each with the place of its axis along the throw, mm."""
        return (self.main_journal, 0.0), (self.crankpin, self.radius_mm)

    @property
    def has_fillets(self) -> bool:
        """True unless both journals are sharp."""
        return any(journal.fillet_mm > 0 for journal, _ in self.journals)

    def features(self) -> Iterator[tuple[str, Feature]]:
        """Yield each feature of journals and web together with its key path in the scene."""
        for index, drilling in enumerate(self.drilling):
            yield f"throw.drilling[{index}]", drilling

    def check_bores_apart(self) -> None:
        """Refuse bores that meet in the web, through which both run."""
        main, pin, radius = self.main_journal, self.crankpin, self.radius_mm
        if (
            main.bore_diameter_mm
            and pin.bore_diameter_mm
            and main.bore_radius_mm + pin.bore_radius_mm >= radius
        ):
            raise invalid(
                "throw.crankpin.bore_diameter_mm",
                pin.bore_diameter_mm,
                f"pin and main bores meet in the web; their radii must add up to less than {radius:g} mm",
            )


_EffectState = Literal["auto", "on", "off"]
Process = Literal["free", "forged", "cast", "milled"]
"""Process that makes the web; free: any, so that undercuts and closed hollows are possible."""
Parting = Literal["lateral", "web_faces"]
"""Direction in which the halves of a die or mould leave: along x, or along z through the web's faces."""


class _Threshold(SceneTable):
    threshold: float = Field(default=0.02, ge=1e-6, le=0.99)
    """Relative change below which `auto` leaves an effect out."""


def _switches(by_mass: bool) -> dict[str, Any]:
    return {
        name: (_EffectState, Field(default="auto", description=keys.meaning))
        for name, keys in LOAD_KINDS.items()
        if keys.by_mass == by_mass
    }


if TYPE_CHECKING:

    class _ForceSwitches(_Threshold): ...

else:
    _ForceSwitches = create_model("_ForceSwitches", __base__=_Threshold, **_switches(by_mass=False))


class _InertiaSwitches(_ForceSwitches):
    reciprocating_inertia: _EffectState = "auto"
    """Inertia of piston and upper end of the rod in the rod force."""
    rotating_rod_mass: _EffectState = "auto"
    """Centrifugal force of the rod's big end on the crankpin."""


def _weight(name: str, keys: LoadKeys) -> Any:
    return Weight, Field(default=keys.weight, description=f"Weight of the {name} case.")


if TYPE_CHECKING:

    class _LoadSwitches(_InertiaSwitches): ...

    class _LoadWeights(SceneTable): ...

else:
    _LoadSwitches = create_model("_LoadSwitches", __base__=_InertiaSwitches, **_switches(by_mass=True))
    _LoadWeights = create_model(
        "_LoadWeights",
        __base__=SceneTable,
        **{name: _weight(name, keys) for name, keys in LOAD_KINDS.items()},
    )


class Effects(_LoadSwitches):
    """State of each effect, and the relative change below which `auto` leaves an effect out."""

    torsional_vibration: _EffectState = "auto"
    """Torque of the vibrating shaft at its worst speed in place of the quasi-static one; needs `[shaft]`."""
    bearing_compliance: _EffectState = "auto"
    """Springs of the main bearings in series with the throw; on where one of `[supports]` is "spring"."""
    continuous_shaft: _EffectState = "auto"
    """Load states of `fatigue`, `compare` and `shape` from the shaft on all its bearings, over its range of
    speeds, in place of a throw alone; `auto` takes them where they bend a web more."""
    fillets: _EffectState = "auto"
    """Fillets of the journals in the body-fitted evaluation."""
    bores: _EffectState = "auto"
    """Bores of journals and web; off: solid journals."""
    lateral_symmetry: _EffectState = "auto"
    """Use of the mirror plane x = 0: half the cells, same answer."""
    manufacturing_constraint: _EffectState = "auto"
    """Forging, casting or milling constraint of the density optimisation; needs `optimise.process`."""
    fatigue: _EffectState = "auto"
    """Fatigue safety in the plan and in `compare`."""
    bound: _EffectState = "auto"
    """Bound that no web of the envelope can beat, proven and shown beside a result."""


class Weights(_LoadWeights):
    """Weight of each load case in the objective; at 0 the plan leaves a case out."""


_OptimiserMethod = Literal["auto", "optimality_criteria", "moving_asymptotes"]


class Optimise(SceneTable):
    """Settings of the density optimisation."""

    volume_fraction: Fraction = 0.3
    """Volume of the optimised web over the volume of the design space."""
    resolution_mm: float = Field(default=1.5, ge=1e-3, le=1000)
    """Edge of the cells; each direction is adjusted so that cells end at the web's faces. The default is for
    journals of 42 to 84 mm; others have cells in proportion."""
    filter_radius_mm: Length | None = Field(default=None, examples=[3.0])
    """Radius of the cone filter; by default 2.5 cells, at least 3 mm, or more where `min_member_mm` or
    `min_gap_mm` need it; at most half of the design space."""
    min_member_mm: Length | None = Field(default=None, examples=[6.0])
    """Least thickness of a member that the optimisation shapes; at least 2 cells."""
    min_gap_mm: Length | None = Field(default=None, examples=[6.0])
    """Least width of a gap, pocket or hole that the optimisation shapes; at least 2 cells."""
    max_iterations: int = Field(default=150, ge=1, le=10000)
    """Iterations after which the optimisation stops even if it has not converged."""
    weights: Weights = Weights()
    combine: Literal["sum", "worst"] = "sum"
    """Without a goal: minimise the weighted `sum` of the load cases' compliances, or the `worst` of them."""
    method: _OptimiserMethod = "auto"
    """Way to the next design: `optimality_criteria` for the plain sum at a volume fraction, the method
    of `moving_asymptotes` for anything; `auto`: the former where it can."""
    limits_by_evaluation: bool = True
    """With a goal: the surface is evaluated on body-fitted elements, and the limits in the cells are moved by
    the error that shows until they hold by the evaluation; `false`: they hold in the cells."""
    penalty: float = Field(default=3.0, ge=1, le=10)
    """Power of the density in the modulus (SIMP)."""
    projection_first: float = Field(default=1.0, ge=0.01, le=1000)
    """Steepness of the projection in the first stage; it doubles from stage to stage."""
    projection_last: float = Field(default=16.0, ge=0.01, le=1000)
    """Steepness of the projection in the last stage; above 16 webs get blacker, hardly stiffer."""
    stage_iterations: int = Field(default=6, ge=1, le=1000)
    """Most iterations of a stage before the last."""
    move: float = Field(default=0.2, ge=0.001, le=1)
    """Largest change of a design variable by one step of the first stage; later ones take smaller steps."""
    process: Process = Field(default="free", examples=["forged"], json_schema_extra=SHOWN)
    """Process that makes the web: `forged` by a die with a flat parting plane, `cast` in a mould of two
    halves with any parting surface, `milled` from both web faces and both sides, or `free`."""
    parting: Parting = "lateral"
    """Opening of die and mould: `lateral` along x, the die parting in x = 0; `web_faces` along z, mid-web."""
    draft_deg: float = Field(default=0.0, ge=0, le=20, examples=[5.0], json_schema_extra=SHOWN)
    """Least angle between the walls of a forged or cast web and the way its die or mould opens."""
    tool_radius_mm: Length | None = Field(default=None, examples=[5.0])
    """Radius of the end mill of a milled web; by default a tenth of the throw radius."""


class Original(SceneTable):
    """The web that gains are measured against, as a body from CAD; by default it is that of `[web]`."""

    file: str = Field(examples=["original.step"])
    """STL in mm or STEP of the half throw, z along the crank and y along the throw; relative to this file.
    Where the halves of the throw differ, of the first one."""
    second_file: str | None = Field(default=None, examples=["original-2.step"], exclude_if=is_unset)
    """The same of the half beyond the crankpin where the halves differ, described as `[second_web]` is."""


class Scene(SceneTable):
    """One throw, its loads, its design space and the settings of each stage."""

    schema_version: Annotated[Literal[1], WholeNumber] = 1
    """Version of this format."""
    name: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$", examples=["my-engine"])
    """Name of the design in tables and run folders: letters, digits, dot, hyphen and underscore."""
    description: str = ""
    """One line about the design, for `cranktopo designs list`."""
    throw: ThrowTable
    """The crank throw without its web."""
    web: Web
    """The web between main journal and crankpin, both of them alike; `outline` chooses its shape."""
    second_web: Web | None = Field(default=None, json_schema_extra=LIKE_WEB)
    """The web beyond the crankpin where it differs from `[web]`, with the same keys and the same tables of
    features; without it both webs are alike. Each is described from its own main journal on."""
    material: Material
    """Linear elastic, isotropic material; the whole crankshaft is made of it."""
    supports: Supports = Supports()
    engine: Engine | None = None
    shaft: ShaftTable | None = None
    crank: Crank | None = None
    bearings: PlainBearings | None = None
    forging: Forging | None = Field(default=None, exclude_if=is_unset)
    rod: Rod | None = None
    balancer: BalancerPart | None = None
    bolted_joint: tuple[BoltedJoint, ...] = Field(default=(), max_length=64)
    envelope: Envelope | None = None
    """Space that the optimised web may fill, within the web's thickness; needed to optimise."""
    original: Original | None = None
    goal: GoalTable | None = None
    effects: Effects = Effects()
    optimise: Optimise = Optimise()
    shape: ShapeTable = ShapeTable()
    fatigue: Fatigue = Fatigue()
    drawing: Drawing = Drawing()
    published: Published | None = None

    def with_optimise(self, **changes: object) -> Scene:
        """Return the scene with other settings of `[optimise]`, by name; None keeps its own."""
        settings_given = {key: value for key, value in changes.items() if value is not None}
        try:
            settings = Optimise.model_validate({**self.optimise.model_dump(), **settings_given})
        except ValidationError as error:
            raise explain(error, self.name, ("optimise",)) from None
        return self.model_copy(update={"optimise": settings})

    def with_drillings(self, drillings: tuple[Drilling, ...]) -> Scene:
        """Return the scene with these drillings alone; nothing is checked."""
        return self.model_copy(update={"throw": self.throw.model_copy(update={"drilling": drillings})})

    def with_effect(self, effect: str, state: _EffectState) -> Scene:
        """Return the scene with one effect switched; the same object when it is so already."""
        if getattr(self.effects, effect) == state:
            return self
        return self.model_copy(update={"effects": self.effects.model_copy(update={effect: state})})

    def invalid(self, key: str, allowed: str, hint: str = "") -> CranktopoError:
        """Return the refusal of the value at a key path such as `web.pocket[0].y_mm`."""
        value: Any = self
        for name, place in re.findall(r"(\w+)(?:\[(\d+)\])?", key):
            value = getattr(value, name)[int(place)] if place else getattr(value, name)
        return invalid(key, list(value) if isinstance(value, tuple) else value, allowed, hint)

    @property
    def pitch_mm(self) -> float:
        """Distance between neighbouring mid-main-journal planes, mm."""
        throw, second = self.throw, self.second_web or self.web
        main, pin = throw.main_journal.length_mm, throw.crankpin.length_mm
        beyond = (throw.second_main_journal or throw.main_journal).length_mm
        journals = (main + (throw.second_main_journal_length_mm or beyond)) / 2
        pins = (pin + (throw.second_crankpin_length_mm or pin)) / 2
        return journals + pins + (self.web.thickness_mm + second.thickness_mm)

    @property
    def rod_offset_mm(self) -> float:
        """Distance along the shaft of neighbouring rods on a pin, mm; 0 for one rod or those of a radial.

        By default the pin's length over the number of its rods.
        """
        engine = self.engine
        if engine is None or engine.rods_per_pin == 1 or engine.arranged.layout == "radial":
            return 0.0
        offset_mm = engine.arranged.rod_offset_mm
        return self.throw.crankpin.length_mm / engine.rods_per_pin if offset_mm is None else offset_mm

    @property
    def rod_places_mm(self) -> tuple[float, ...]:
        """Place of every rod on a pin from its middle, toward the takeoff, the first bank's first, mm."""
        rods = self.engine.rods_per_pin if self.engine else 1
        return tuple(self.rod_offset_mm * (rod - (rods - 1) / 2) for rod in range(rods))

    @property
    def has_master_rod(self) -> bool:
        """True where one big end carries the rods of three or more cylinders, all in one plane."""
        return self.engine is not None and self.engine.rods_per_pin > 2 and not self.rod_offset_mm

    @property
    def big_ends(self) -> int:
        """Number of big ends beside each other on a pin."""
        return 1 if self.engine is None or self.has_master_rod else self.engine.rods_per_pin

    @property
    def web_z_mm(self) -> tuple[float, float]:
        """Axial range (journal face, pin face) of the web of the half throw, of two webs the first, mm."""
        start = self.throw.main_journal.length_mm / 2
        return start, start + self.web.thickness_mm

    @property
    def shaft_angles_deg(self) -> tuple[float, ...]:
        """Angle of every throw in the sense of rotation, deg, cylinder 1 first and at 0; needs an engine."""
        if self.engine is None:
            raise CranktopoError(
                f"{self.name}: [engine] is missing: the whole shaft needs its cylinders and firing order.",
                hint="Add [engine] with bore_mm, rod_length_mm, speed_rpm, cylinders and firing_order.",
            )
        return self.engine.throw_angles_deg


register_root(Scene)
