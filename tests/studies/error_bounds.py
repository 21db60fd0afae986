"""Error bounds of the body-fitted evaluation against true errors, on built-in designs and random throws.

What is true comes from cubic displacements on the mesh of the default size, less a share for what lies beyond
them and what its straightened elements add, and is kept in `tests/data/cubic_stiffness.json` (`python -m
tests.benchmarks.error_estimates --make`).
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import Any, Literal

from cranktopo.design.halves import default_element_size_mm
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.numerics.tetrahedra.mesh import RATIO
from cranktopo.tasks.throw_fea.error_bound import difference_bound_percent
from cranktopo.tasks.throw_fea.evaluation import evaluate
from cranktopo.tasks.throw_fea.targets import Target
from tests.random_throws import random_variant
from tests.studies.cubic_elements import Both, both_orders

Stiffness = Literal["torsion", "bending"]
STIFFNESSES: tuple[Stiffness, ...] = ("torsion", "bending")
STORED = Path(__file__).parents[1] / "data" / "cubic_stiffness.json"
BEYOND_CUBIC = {"torsion": {"fillets": 0.11, "sharp": 0.19}, "bending": {"fillets": 0.11, "sharp": 0.32}}
"""Error of cubic displacements over what they take off quadratic ones, from meshes 1.5 times finer.

With fillets 0.06 to 0.16 on four throws, so that a true error is known to 5 %.
"""
THREE_WEBS = range(3)
"""Numbers of the webs of a random throw."""
_ORDER = 1.3


def limit(coarse: float, fine: float) -> float:
    """What two meshes, the finer one by a factor of 1.5, converge to with order 1.3."""
    return fine + (fine - coarse) / (RATIO**_ORDER - 1)


@dataclass(frozen=True, kw_only=True)
class Bounded:
    """A stiffness of a design, or a difference between two, the bound of its error, and its true error, %."""

    design: str
    quantity: str
    bound_percent: float
    error_percent: float

    @property
    def holds(self) -> bool:
        """Whether the bound is one."""
        return abs(self.error_percent) <= self.bound_percent


@dataclass(frozen=True, kw_only=True)
class Difference(Bounded):
    """The relative difference between the stiffnesses of two webs.

    Attributes:
        change_percent: the difference itself.
        single_percent: mean bound of the two stiffnesses.
    """

    change_percent: float
    single_percent: float


def held_text(rows: Sequence[Bounded]) -> str:
    """How many bounds hold."""
    held = sum(row.holds for row in rows)
    return f"\n{held} of {len(rows)} within their bound: {100 * held / len(rows):.1f} %"


def target_of(name: str) -> Target:
    """A built-in design, random-SEED, or random-SEED-NUMBER of `random_variant`."""
    scene = _scene_of(name)
    return Target(scene.name, planned_scene(scene))


def _scene_of(name: str) -> Scene:
    kind, *numbers = name.split("-") if name.startswith("random-") else (name,)
    seed, variant, *_ = (*(int(number) for number in numbers), 0, 0)
    return random_variant(seed, variant) if kind == "random" else load_scene(name)


def body_digest(name: str) -> str:
    """A digest of what a design's stiffness rests on, to nine digits: a truth is one of that body."""
    tables = {"throw", "web", "material"}
    text = _scene_of(name).model_dump_json(include=tables, exclude_defaults=True)
    rounded = json.loads(text, parse_float=lambda number: f"{float(number):.9g}")
    return hashlib.sha256(json.dumps(rounded, sort_keys=True).encode()).hexdigest()[:16]


def stored_digests() -> dict[str, str]:
    """Digests of the bodies whose truth is stored."""
    return {name: found["body"] for name, found in _stored().items()}


def size_mm(target: Target, steps: int) -> float:
    """Element size 1.5 to the power of `steps` times the default."""
    return default_element_size_mm(target.scene) * RATIO**steps


def make_truth(name: str) -> None:
    """Solve a design with both orders on its default mesh and store it, where that was not done; a minute."""
    target, stored = target_of(name), _stored()
    if name in stored:
        return
    both = both_orders(target, size_mm(target, 0))
    stored[name] = {"body": body_digest(name), **{kind: asdict(one) for kind, one in both.items()}}
    STORED.write_text(json.dumps(stored, indent=1, sort_keys=True) + "\n", encoding="utf-8")


def stored_names() -> list[str]:
    """Random throws with their own web, and built-in designs, whose truth is stored."""
    return [name for name in _stored() if not name.startswith("random-") or name.endswith("-0")]


def stored_families() -> list[int]:
    """Seeds of random throws with the truth of all their webs stored."""
    stored = _stored()
    seeds = {int(name.split("-")[1]) for name in stored if name.startswith("random-")}
    return [s for s in sorted(seeds) if all(name in stored for name in family(s))]


def family(seed: int) -> list[str]:
    """Names of the webs of a random throw."""
    return [f"random-{seed}-{number}" for number in THREE_WEBS]


def truth(name: str) -> dict[str, float]:
    """True torsional (free) and bending stiffness (pinned) by what is stored."""
    fillet = target_of(name).scene.throw.main_journal.fillet_mm
    found = dict[str, float]()
    for kind in STIFFNESSES:
        both = Both(**_stored()[name][kind])
        beyond = BEYOND_CUBIC[kind]["fillets" if fillet else "sharp"]
        found[kind] = (both.cubic - beyond * (both.quadratic - both.cubic)) * (1 - both.straight)
    return found


def single_errors(name: str, steps: int = 0) -> Iterator[Bounded]:
    """Bounds and true errors of both stiffnesses of a design."""
    true, values, bounds = truth(name), *_evaluated(name, steps)
    for kind in STIFFNESSES:
        error = 100 * (values[kind] / true[kind] - 1)
        yield Bounded(design=name, quantity=kind, bound_percent=bounds[kind], error_percent=error)


def pair_errors(seed: int, steps: int = 1) -> Iterator[Difference]:
    """Bounds and true errors of the differences between the three webs of a random throw."""
    for one, other in combinations(family(seed), 2):
        (values, bounds), (others, their_bounds) = _evaluated(one, steps), _evaluated(other, steps)
        true, their_truth = truth(one), truth(other)
        for kind in STIFFNESSES:
            change = others[kind] / values[kind]
            yield Difference(
                design=f"{one} and {other[-1]}",
                quantity=kind,
                bound_percent=difference_bound_percent(bounds[kind], their_bounds[kind]),
                error_percent=100 * (change * true[kind] / their_truth[kind] - 1),
                change_percent=100 * (change - 1),
                single_percent=(bounds[kind] + their_bounds[kind]) / 2,
            )


def _stored() -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = (
        json.loads(STORED.read_text(encoding="utf-8")) if STORED.exists() else {}
    )
    return found


@cache
def _evaluated(name: str, steps: int) -> tuple[dict[str, float], dict[str, float]]:
    """Both stiffnesses and their bounds by name, with free and pinned sections."""
    target = target_of(name)
    found = evaluate(target, size_mm(target, steps)).fine
    values = {"torsion": found.torsion["free"], "bending": found.bending["pinned"]}
    bounds = {
        "torsion": found.torsion_error_percent["free"],
        "bending": found.bending_error_percent["pinned"],
    }
    return _numbers(values), _numbers(bounds)


def _numbers(values: dict[str, float | None]) -> dict[str, float]:
    return {name: value for name, value in values.items() if value is not None}
