"""The compared quantities of a throw: name, unit, how to print, and which way is better. The only such table.

Tables, plots, pages and verdicts look a quantity up here; what holds values of it, holds them by its key.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from cranktopo.base.units import number_text, stem_and_unit
from cranktopo.design.balance_factor import balance_factor_percent
from cranktopo.design.goal.scene_goal import goal_of
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.states import load_cases
from cranktopo.report.result_table import Column, ResultTable, tabulate
from cranktopo.tasks.throw_fea.evaluation import Evaluation
from cranktopo.tasks.throw_fea.result import EvaluationResult


def goal_values(scene: Scene, evaluation: EvaluationResult) -> dict[str, float]:
    """Return the quantities of a goal that an evaluation tells, each in its internal unit."""
    mass, torsion, bending = (
        evaluation.mass_kg.throw,
        evaluation.torsion_Nm_per_rad,
        evaluation.bending_N_per_mm,
    )
    known = {
        "balance_factor": balance_factor_percent(scene, evaluation.unbalance_kg_mm),
        "natural_frequency": evaluation.natural_frequency_Hz,
        "fatigue_safety": evaluation.fatigue_safety,
        "stress": evaluation.stress_MPa,
    }
    return {
        "mass": mass,
        "inertia": evaluation.inertia_kg_mm2,
        "unbalance": evaluation.unbalance_kg_mm,
        "torsion": torsion,
        "bending": bending,
        "torsion_per_mass": torsion / mass,
        "bending_per_mass": bending / mass,
        **_motions(scene, torsion, bending),
        **{name: value for name, value in known.items() if value is not None},
    }


def _motions(scene: Scene, torsion: float, bending: float) -> dict[str, float]:
    if scene.engine is None:
        return {}
    cases = {case.kind: case for case in load_cases(scene, plan(scene, goal=goal_of(scene)).enabled)}
    motions = {}
    if "bending" in cases:
        motions["pin_displacement"] = abs(cases["bending"].radial_N) / bending
    if "torsion" in cases:
        motions["twist"] = math.degrees(abs(cases["torsion"].torque_Nm) / torsion)
    return motions


_ErrorKind = Literal["torsion", "bending", "safety"]


@dataclass(frozen=True)
class Quantity:
    """Something that webs are compared by.

    Attributes:
        unit: as machine names end, e.g. `kNm_per_rad_kg`; empty for a pure number.
        better: +1 where more is better, -1 where less is.
        error: which error estimate it carries; None where it is exact.
    """

    key: str
    label: str
    unit: str
    digits: int
    better: Literal[-1, 1]
    error: _ErrorKind | None = None

    @property
    def column(self) -> str:
        """Machine name of its values, unit included."""
        return f"{self.key}_{self.unit}" if self.unit else self.key

    @property
    def percent_column(self) -> str:
        """Machine name of its values in percent of a reference."""
        return f"{self.key}_percent"


MASS = Quantity("mass", "mass of the throw", "kg", 3, -1)
TORSION = Quantity("torsion", "torsional stiffness", "kNm_per_rad", 2, 1, "torsion")
BENDING = Quantity("bending", "bending stiffness", "kN_per_mm", 2, 1, "bending")
TORSION_PER_MASS = Quantity(
    "torsion_per_mass", "torsional stiffness per mass", "kNm_per_rad_kg", 2, 1, "torsion"
)
BENDING_PER_MASS = Quantity("bending_per_mass", "bending stiffness per mass", "kN_per_mm_kg", 2, 1, "bending")
INERTIA = Quantity("inertia", "inertia about the crank axis", "kg_mm2", 0, -1)
UNBALANCE = Quantity("unbalance", "unbalance", "kg_mm", 2, -1)
SAFETY = Quantity("safety", "fatigue safety", "", 3, 1, "safety")
NATURAL_FREQUENCY = Quantity("natural_frequency", "first natural frequency in torsion", "Hz", 1, 1)
STRESS = Quantity("stress", "largest von Mises stress", "MPa", 1, -1)
OIL_FILM = Quantity("oil_film", "least oil film", "um", 2, 1)
BEARING_PRESSURE = Quantity("bearing_pressure", "largest film pressure", "MPa", 1, -1)

STIFFNESS = (TORSION, BENDING)
PER_MASS = (TORSION_PER_MASS, BENDING_PER_MASS)
COMPARED = (MASS, *STIFFNESS, *PER_MASS, INERTIA, UNBALANCE)
"""Quantities that every comparison shows; safety is added where fatigue was assessed."""
_FEW = 2
"""Decimals of quantities of which four digits are enough."""


def quantity_text(quantity: Quantity, value: float) -> str:
    """Return a value with its unit as cards tell it: `1.510 kg`, `157.7 kN m/rad`."""
    text = f"{value:.{quantity.digits}f}" if quantity.digits > _FEW else number_text(value)
    return f"{text} {stem_and_unit(quantity.column)[1]}".rstrip()


def throw_values(mass_kg: float, torsion_Nm_per_rad: float, bending_N_per_mm: float) -> dict[str, float]:
    """Return mass, stiffnesses and ratios by key, in the units of the table."""
    torsion, bending = torsion_Nm_per_rad / 1000, bending_N_per_mm / 1000
    return {
        MASS.key: mass_kg,
        TORSION.key: torsion,
        BENDING.key: bending,
        TORSION_PER_MASS.key: torsion / mass_kg,
        BENDING_PER_MASS.key: bending / mass_kg,
    }


def evaluation_values(evaluation: Evaluation) -> dict[str, float]:
    """Return all quantities of an evaluation by key, in the units of the table."""
    return {
        **throw_values(evaluation.throw_kg, evaluation.torsion_Nm_per_rad, evaluation.bending_N_per_mm),
        INERTIA.key: evaluation.inertia_kg_mm2,
        UNBALANCE.key: evaluation.unbalance_kg_mm,
    }


def percent_of(values: Mapping[str, float], reference: Mapping[str, float]) -> dict[str, float]:
    """Return the values in percent of those of a reference, by key."""
    return {key: 100 * value / reference[key] for key, value in values.items()}


NOTICEABLE_PERCENT = 0.05
"""Changes below half of the last printed digit are none."""
_WORDS: dict[Quantity, tuple[str, str]] = {
    MASS: ("heavier", "lighter"),
    TORSION: ("stiffer in torsion", "softer in torsion"),
    BENDING: ("stiffer in bending", "softer in bending"),
}


def comparison_sentence(subject: str, changes_percent: Mapping[Quantity, float], reference: str) -> str:
    """Compare `subject` with `reference` by mass and both stiffnesses; what got worse is in front."""
    worse = [_words(q, v) for q, v in changes_percent.items() if q.better * v < -NOTICEABLE_PERCENT]
    better = [_words(q, v) for q, v in changes_percent.items() if q.better * v > NOTICEABLE_PERCENT]
    if not worse and not better:
        return f"{subject} is like {reference}."
    first, rest = (worse, better) if worse else (better, [])
    return f"{subject} is {_joined(first)} than {reference}" + (f"; it is {_joined(rest)}." if rest else ".")


def worse_line(changes_percent: Mapping[Quantity, float], reference: str) -> str:
    """Return what got worse, for the terminal; empty where nothing did."""
    worse = [_words(q, v) for q, v in changes_percent.items() if q.better * v < -NOTICEABLE_PERCENT]
    return f"worse than {reference}: {_joined(worse)}" if worse else ""


def percent_change(now: float, before: float) -> float:
    """Return the difference of a value from another, %."""
    return 100 * (now / before - 1)


def _words(quantity: Quantity, percent: float) -> str:
    return f"{abs(percent):.1f} % {_WORDS[quantity][percent < 0]}"


def _joined(parts: list[str]) -> str:
    return f"{', '.join(parts[:-1])} and {parts[-1]}" if len(parts) > 1 else parts[0]


_COLUMNS: tuple[Column[Evaluation], ...] = (
    Column("target", 0, lambda e: e.target),
    Column("throw_kg", MASS.digits, lambda e: e.throw_kg),
    Column("web_kg", MASS.digits, lambda e: e.web_kg),
    Column("second_web_kg", MASS.digits, lambda e: e.second_web_kg),
    Column(INERTIA.column, INERTIA.digits, lambda e: e.inertia_kg_mm2),
    Column(UNBALANCE.column, UNBALANCE.digits, lambda e: e.unbalance_kg_mm),
    Column("torsion_free_kNm_per_rad", 2, lambda e: _kilo(e.fine.torsion["free"])),
    Column("held_kNm_per_rad", 2, lambda e: _kilo(e.fine.torsion["held"])),
    Column("torsion_spring_kNm_per_rad", 2, lambda e: _kilo(e.fine.torsion["spring"])),
    Column("bending_pinned_kN_per_mm", 2, lambda e: _kilo(e.fine.bending["pinned"])),
    Column("clamped_kN_per_mm", 1, lambda e: _kilo(e.fine.bending["clamped"])),
    Column("bending_spring_kN_per_mm", 2, lambda e: _kilo(e.fine.bending["spring"])),
    Column("torsion_error_percent", 2, lambda e: e.torsion_error_percent),
    Column("bending_error_percent", 2, lambda e: e.bending_error_percent),
    Column("size_mm", 2, lambda e: e.fine.element_size_mm),
    Column("nodes", 0, lambda e: float(e.fine.nodes)),
    Column("time_s", 1, lambda e: e.total_seconds),
)


_ONLY_WHERE: dict[str, Callable[[Evaluation], bool]] = {
    "second_web_kg": lambda e: e.second_web_kg is not None,
    "torsion_spring_kNm_per_rad": lambda e: e.torsion_support == "spring",
    "bending_spring_kN_per_mm": lambda e: e.bending_support == "spring",
}
"""Columns that stand where an evaluation has need of them."""


def evaluation_table(evaluations: Sequence[Evaluation]) -> ResultTable:
    """Return one row per evaluation: mass, inertia, unbalance, stiffnesses, error estimates, mesh, seconds.

    Where the webs of a throw differ, both have a column, and where a support is "spring" that stiffness has
    one. The errors are those with the supports of each design.
    """
    columns = [
        column
        for column in _COLUMNS
        if column.name not in _ONLY_WHERE or any(map(_ONLY_WHERE[column.name], evaluations))
    ]
    return tabulate(columns, evaluations)


def result_line(e: Evaluation) -> str:
    """Return both stiffnesses of the design's supports, each with its estimate, and what they took."""
    return (
        f"{e.target}: torsion{_support(e.torsion_support)} {e.torsion_Nm_per_rad / 1000:.2f} kN m/rad, "
        f"+-{e.torsion_error_percent:.2g} %; bending{_support(e.bending_support)} "
        f"{e.bending_N_per_mm / 1000:.2f} kN/mm, +-{e.bending_error_percent:.2g} %; {e.total_seconds:.1f} s"
    )


def _support(name: str) -> str:
    """Return a support for beside its stiffness; empty of those by default."""
    return "" if name in ("free", "pinned") else f" ({name})"


def estimate_line(torsion_percent: Iterable[float], bending_percent: Iterable[float]) -> str:
    """Return the largest error estimates of several evaluations, for below a table of their stiffnesses."""
    torsion, bending = max(torsion_percent), max(bending_percent)
    return f"stiffnesses +-{torsion:.2g} % in torsion, +-{bending:.2g} % in bending at most"


def _kilo(value: float | None) -> float | None:
    return None if value is None else value / 1000
