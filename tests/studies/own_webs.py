"""Density optimisations at the volume of the design's own web, against that web.

`python -m tests.studies.own_webs [DESIGN[:PROCESS] | SEED ...]`: a number is a random engine with all
features by its process; a design goes by every process. A design without an envelope, as the sources' ideas
of another web are, has that of its engine. Both webs are judged twice: on the optimiser's cells, and by the
body-fitted evaluation of the extracted surface against the exact web without fillets. Stiffness per mass is
the reciprocal of the weighted compliance under bending and torsion, the objective, times the mass. What of an
own web lies outside of the envelope no optimised web can have; such a row compares nothing.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from pathlib import Path

from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import silent
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.cells.outside import outside_envelope
from cranktopo.design.halves import usual_scale
from cranktopo.design.load_kinds import MAIN_KINDS
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.engine.plan.simulated import strip_features
from cranktopo.tasks.density.stage import prepare
from cranktopo.tasks.optimise.stage import optimise_design
from cranktopo.tasks.throw_fea.evaluation import evaluate
from cranktopo.tasks.throw_fea.targets import Target
from tests.hostile.featured_engines import PROCESSES, featured_engine

DESIGNS = (
    "mikron-iiic",
    "mikron-iiic-plain",
    "mikron-iiic-hollow",
    "mikron-iiic-rounded",
    "car-diesel",
    "industrial-gas",
    "opposed-piston",
    "opposed-piston-casting",
    "opposed-piston-forging",
    "opposed-piston-variant-1",
    "opposed-piston-variant-2",
)
ENGINES = "mikron-iiic", "opposed-piston"
CELL_MM = 3.0
"""On a throw of the Mikron's size; in proportion on others."""


def scenes(name: str) -> Iterator[Scene]:
    """Scenes of a name by the processes that they are tried with, without goal and proof."""
    if name.isdigit():
        data = featured_engine(int(name))
        data.pop("second_web", None)  # its own volume is that of one web
        found = [scene_from_dict(data)]
    else:
        design, _, process = name.partition(":")
        own = in_envelope(load_scene(design))
        found = [own.with_optimise(process=one) for one in ([process] if process else PROCESSES)]
    for scene in found:
        bare = scene.model_copy(update={"goal": None}).with_effect("bound", "off")
        yield bare.with_optimise(resolution_mm=CELL_MM / usual_scale(scene))


def in_envelope(scene: Scene) -> Scene:
    """A scene in the envelope of its engine, the design whose name begins its own, where it has none."""
    if scene.envelope is not None:
        return scene
    engine = load_scene(next(name for name in ENGINES if scene.name.startswith(name)))
    return scene.model_copy(update={key: getattr(engine, key) for key in ("envelope", "optimise", "effects")})


def own_volume_fraction(scene: Scene) -> float:
    """Share of the design space that the scene's own web fills, on the optimiser's cells."""
    prepared = prepare(scene)
    domain, own = prepared.domain, prepared.scene
    web = build_domain(own, own.optimise.resolution_mm, "web", domain.extent, domain.grid)
    first, last = domain.web_layers
    layers = slice(first, last)
    solid = (web.passive_fraction - domain.passive_fraction)[:, :, layers] * domain.volume_mm3[:, :, layers]
    space = domain.design_fraction[:, :, layers] * domain.volume_mm3[:, :, layers]
    return float(solid.sum() / space.sum())


def compared(scene: Scene) -> str:
    """Return a row: what the optimised web reaches of the own web's stiffness per mass, by either model."""
    began, share, outside = time.perf_counter(), own_volume_fraction(scene), outside_envelope(scene)
    with tempfile.TemporaryDirectory() as where, silent():
        run = optimise_design(scene.with_optimise(volume_fraction=share), Path(where) / "run")
        found, before = run.metrics.load_cases, run.metrics.original_web.load_cases
        mass = run.metrics.mass_kg.throw / run.metrics.original_web.mass_kg.throw
        work = {name: one.compliance_N_mm for name, one in before.items() if one.load.kind in MAIN_KINDS}
        cells = _per_mass(
            scene, work, {name: found[name].compliance_N_mm / work[name] for name in work}, mass
        )
        simulated = planned_scene(scene)
        own = evaluate(Target(scene.name, strip_features(simulated, "fillets")))  # a density has none
        new = evaluate(Target(scene.name, simulated, run.folder / "web.stl"))
        stiffer = {
            "torsion": new.torsion_Nm_per_rad / own.torsion_Nm_per_rad,
            "bending": new.bending_N_per_mm / own.bending_N_per_mm,
        }
        of_kinds = {name: 1 / stiffer[before[name].load.kind] for name in work}
        fitted = _per_mass(scene, work, of_kinds, new.throw_kg / own.throw_kg)
    told = f"{share:.3f}", f"{outside.percent if outside else 0.0:.1f}", str(run.metrics.iterations)
    changes = f"{cells:+.2f}", f"{fitted:+.2f}", f"{time.perf_counter() - began:.0f}"
    return _row(scene.name, scene.optimise.process, *told, *changes)


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"


def _per_mass(scene: Scene, work: Mapping[str, float], ratio: Mapping[str, float], mass: float) -> float:
    """Change of the stiffness per mass in percent, from every case's compliance over that of the own web."""
    weights = scene.optimise.weights
    weighted = {name: float(getattr(weights, name)) * value for name, value in work.items()}
    share = sum(value * ratio[name] for name, value in weighted.items()) / sum(weighted.values())
    return 100 * (1 / (share * mass) - 1)


def main(*names: str) -> None:
    """Print the table as Markdown."""
    heads = "own volume fraction", "outside %", "iterations", "on cells %", "body-fitted %", "s"
    print(_row("design", "process", *heads))
    print(_row(*["---"] * 8))
    for name in names or (*DESIGNS, *map(str, range(40))):
        for scene in scenes(name):
            try:
                print(compared(scene), flush=True)
            except CranktopoError as error:
                row = scene.name, scene.optimise.process, "", "", "", "", str(error), ""
                print(_row(*row), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
