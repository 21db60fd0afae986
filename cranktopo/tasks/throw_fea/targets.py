"""Targets of an evaluation: a design, a run, or an STL or STEP file with a design for its journals."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import note
from cranktopo.design.assumed import (
    FATIGUE,
    LOADS,
    SUPPORTS,
    THROW,
    VIBRATION,
    Assumption,
    assumptions,
    stored_assumptions,
)
from cranktopo.design.flying_web import FlyingWeb, flying_webs, web_at_a_bearing
from cranktopo.design.halves import require_equal_halves
from cranktopo.design.loading import builtin_designs, load_scene, one_web, shaped_web
from cranktopo.design.schema import Scene
from cranktopo.design.writing import design_from_run
from cranktopo.engine.one_throw import one_throw
from cranktopo.engine.plan.planning import left_out_features, planned_scene
from cranktopo.engine.plan.simulated import Feature
from cranktopo.runs.directories import RunStore, open_run, runs_named
from cranktopo.runs.kind import require_kind
from cranktopo.runs.stored import unchanged

_GEOMETRY = (".stl", ".step", ".stp")
_TRIANGLES = ".stl"
_RUN_SURFACE = "web.stl"
USED = (THROW, LOADS, VIBRATION, SUPPORTS, FATIGUE)
"""Tables of a scene that evaluations may use; `among` takes what one of them does."""


@dataclass(frozen=True)
class Target:
    """Something to evaluate.

    Attributes:
        scene: journals, material, supports, without what the effects plan leaves out; the whole geometry
            where `file` is None.
        file: STL or STEP of the half throw, mm.
        assumed: what the design does not say of throw, engine, supports and fatigue.
        left_out: features that the plan takes out of `scene`, and why; empty where none is.
        design: before its effects plan was applied; None where only the planned scene is known.
        flying: each distinct flying web of the crank that the throw was taken from, without what its plan
            leaves out.
        throw_stiffness_source: where the stiffness in the shaft table comes from, unless the design gives it.
    """

    name: str
    scene: Scene
    file: Path | None = None
    run: Path | None = None
    align: bool = False
    assumed: tuple[Assumption, ...] = ()
    left_out: str = ""
    design: Scene | None = None
    flying: tuple[FlyingWeb, ...] = ()
    throw_stiffness_source: str = ""

    @property
    def triangles(self) -> bool:
        """True if the body is a surface of triangles, which meshes replace, and no exact solid."""
        return self.file is not None and self.file.suffix.lower() == _TRIANGLES


TargetLike = Target | Scene | str | Path
"""A target, a scene, or what the user types: a path or a name."""


def resolve_targets(
    texts: Sequence[TargetLike],
    design: str | None = None,
    fillets: bool = False,
    align: bool = False,
    *,
    whole: bool = False,
    throw: int | None = None,
    crank: bool = False,
) -> list[Target]:
    """Return targets from what the user typed, each with a name of its own; errors as of `resolve_target`."""
    kept = _Kept(fillets, whole, throw, crank)
    found = [_resolved(text, design, align, kept) for text in texts]
    if not any(target.file and not target.run for target in found):
        _refuse_for_bodies(design, align)
    for name in (lambda text: Path(text).stem, str):
        taken = Counter(target.name for target in found)
        found = [
            replace(target, name=name(text)) if taken[target.name] > 1 and _typed(text) else target
            for target, text in zip(found, texts, strict=True)
        ]
    seen: Counter[str] = Counter()
    for index, (target, text) in enumerate(zip(found, texts, strict=True)):
        seen[target.name] += 1
        if seen[target.name] > 1 and isinstance(text, Scene):
            found[index] = replace(target, name=f"{target.name}-{seen[target.name]}")
    return found


def _typed(text: TargetLike) -> bool:
    return isinstance(text, str | Path)


def resolve_target(
    text: TargetLike,
    design: str | None = None,
    fillets: bool = False,
    align: bool = False,
    *,
    whole: bool = False,
    crank: bool = False,
) -> Target:
    """Return a target from what the user typed, or from a scene; a target is returned as it is.

    Args:
        text: design name, TOML path, run of `optimise` or `shape` (directory, name or its beginning), STL or
            STEP path.
        align: moves a body from CAD that lies elsewhere to where the journals are.
        whole: the halves of a design's throw may differ.
        crank: the throws of a design's crank may differ; else one of them is taken.

    Raises:
        CranktopoError: nothing of that name, no finished run of `optimise`, a geometry file without a
            design, or `design` or `align` without a geometry file.
    """
    return resolve_targets([text], design, fillets, align, whole=whole, crank=crank)[0]


def _refuse_for_bodies(design: str | None, align: bool) -> None:
    for option, used in (("--design", design is not None), ("--align", align)):
        if used:
            raise CranktopoError(
                f"{option} is for bodies from CAD, and no target is an STL or STEP file.",
                hint="Leave it out: designs and runs have journals, material and place of their own.",
                code=ExitCode.USAGE,
            )


@dataclass(frozen=True)
class _Kept:
    """Parts that a target keeps of a design: fillets that its plan leaves out, both halves, all throws."""

    fillets: bool
    whole: bool
    throw: int | None
    crank: bool


def _resolved(text: TargetLike, design: str | None, align: bool, kept: _Kept) -> Target:
    if isinstance(text, Target):
        return text
    if isinstance(text, Scene):
        return _of_scene(text, kept)
    path, text = Path(text), str(text)
    named = not path.exists() and text not in builtin_designs() and runs_named(text)
    if path.is_dir() or named:
        shaped = shaped_web(text)
        if shaped is None:
            return _run(open_run(text))
        path, text = shaped, str(shaped)
    if path.suffix.lower() not in _GEOMETRY:
        return _of_scene(load_scene(text, whole=kept.whole), kept)
    if not path.is_file():
        raise CranktopoError(f"target '{text}': no such file.", hint="Give the path of an STL or STEP file.")
    if design is None:
        raise CranktopoError(
            f"target '{text}': needs a design for its journals and material.",
            hint="Add --design NAME.",
            code=ExitCode.USAGE,
        )
    scene, path = load_scene(design), unchanged(path)
    body = planned_scene(scene, ("bores", "fillets"))
    return Target(path.name, body, path, align=align, assumed=assumptions(scene, USED), design=scene)


def _of_scene(scene: Scene, kept: _Kept) -> Target:
    taken = scene if kept.crank else one_throw(scene, kept.throw)
    if not kept.whole:
        require_equal_halves(taken)
    left_out = left_out_features(taken, _kept_features(kept.fillets))
    planned, assumed = simulated(taken, kept.fillets), assumptions(scene, USED)
    flying = () if kept.crank else tuple(_planned_web(web, kept.fillets) for web in flying_webs(scene))
    return Target(taken.name, planned, assumed=assumed, left_out=left_out, design=taken, flying=flying)


def _planned_web(web: FlyingWeb, fillets: bool) -> FlyingWeb:
    return replace(web, near=simulated(web.near, fillets), far=simulated(web.far, fillets))


def at_a_bearing(target: Target) -> Target:
    """Return the throw of two webs like the one at a bearing, of a throw beside a flying web, with a line.

    Another target is returned as it is.
    """
    web = None if target.file else web_at_a_bearing(target.scene)
    if web is None:
        return target
    scene = one_web(target.scene, web)
    note(f"{target.name}: evaluated is a throw with its {web} web twice, the one at a bearing")
    return replace(target, name=scene.name, scene=scene, design=target.design and one_web(target.design, web))


def _run(run: RunStore) -> Target:
    require_kind(run, "optimise")
    if not (run.path / _RUN_SURFACE).is_file():
        raise CranktopoError(
            f"target '{run.path}': {_RUN_SURFACE} is missing, so this is no finished run.",
            hint="Run `cranktopo optimise` to its end, or give an STL file and --design.",
        )
    assumed = stored_assumptions(run.manifest().assumed)
    scene = design_from_run(run)
    left_out = left_out_features(
        scene, _kept_features(fillets=True)
    )  # of which the surface of a run has none
    planned = planned_scene(scene)
    surface = run.unchanged(_RUN_SURFACE)
    return Target(run.name, planned, surface, run.path, assumed=assumed, left_out=left_out, design=scene)


def unlike_fillet_line(targets: Sequence[Target]) -> str:
    """Return the line that surfaces without fillets stand beside designs with them, or will; else nothing."""
    bare = [target.name for target in targets if target.run]
    rounded = [target.name for target in targets if target.file is None and target.scene.throw.has_fillets]
    if bare and all(target.run and target.scene.throw.has_fillets for target in targets):
        return (
            f"{', '.join(bare)}: the surface of a run has no fillets, which make its design stiffer; "
            "cranktopo compare leaves them out of both."
        )
    if not bare or not rounded:
        return ""
    return (
        f"{', '.join(bare)}: the surface of a run has no fillets, which make {', '.join(rounded)} stiffer; "
        "cranktopo compare leaves them out of all."
    )


def simulated(scene: Scene, fillets: bool = False) -> Scene:
    """Return the scene without what its effects plan leaves out; `fillets` keeps these."""
    return planned_scene(scene, _kept_features(fillets))


def _kept_features(fillets: bool) -> tuple[Feature, ...]:
    return ("fillets",) if fillets else ()
