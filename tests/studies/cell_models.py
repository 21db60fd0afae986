"""The optimiser's model of whole webs on cells against body-fitted elements, without fillets."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp

from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.cells.grid import CellGrid
from cranktopo.bodies.solid.checked import solid_properties
from cranktopo.bodies.solid.throw import add_half_throw
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.halves import default_element_size_mm
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.numerics.precision import double_precision
from cranktopo.numerics.tetrahedra.mesh import RATIO
from cranktopo.tasks.density.model import build_model
from cranktopo.tasks.density.problem import model_error_percent
from cranktopo.tasks.density.response import compliances, solve, stiffness
from cranktopo.tasks.refit.fit import scene_with_web
from cranktopo.tasks.throw_fea.evaluation import evaluate_on_mesh
from cranktopo.tasks.throw_fea.targets import Target
from tests.physics.density.throw_cases import BENDING, TORSION
from tests.physics.fea.evaluation_cases import mikron_with
from tests.studies.error_bounds import Bounded, limit
from tests.unit.throw.counterweight_cases import PLAIN, THIN, roomy_scene, weighted

REFERENCE = {"torsion": 138.2e3, "bending": 217.6e3}
"""Body-fitted quadratic tetrahedra refined at the re-entrant rings, N m/rad and N/mm; no fillets."""
CELLS_THROUGH_WEB = (4, 6, 9)


@dataclass(frozen=True)
class Own:
    """Stiffnesses of a whole web by the optimiser's model, N m/rad and N/mm, and what they took."""

    stiffness: dict[str, float]
    unknowns: int
    iterations: int
    cell_mm: float
    grid: CellGrid


def own_model(scene: Scene, cell_mm: float, grid: CellGrid | None = None) -> Own:
    """The scene's web on cells; call inside `double_precision()`."""
    domain = build_domain(scene, cell_mm, "web", grid=grid)
    model = build_model(scene, domain, (BENDING, TORSION))
    solution = solve(model, jnp.asarray(domain.passive_fraction), tolerance=1e-8)
    work = [float(c) for c in compliances(model, solution.displacements)]
    found = {case.name: stiffness(model, c, case.name) for case, c in zip(model.cases, work, strict=True)}
    grid = domain.grid
    return Own(found, model.forces[0].size, int(solution.iterations), grid.largest_edge_mm, grid)


def without_fillets(scene: Scene) -> Scene:
    """The scene as the optimiser sees it."""
    effects = scene.effects.model_copy(update={"fillets": "off", "fatigue": "off"})
    return planned_scene(scene.model_copy(update={"effects": effects}))


def evaluated(scene: Scene, steps: Sequence[int] = (1, 0)) -> dict[str, float]:
    """Stiffnesses by body-fitted elements, extrapolated from two meshes; steps as in `error_bounds`."""
    size = default_element_size_mm(scene)
    rows = [evaluate_on_mesh(Target(scene.name, scene), size * RATIO**step).stiffness for step in steps]
    supports = scene.supports
    pairs = {
        "torsion": [row.torsion[supports.torsion] for row in rows],
        "bending": [row.bending[supports.bending] for row in rows],
    }
    return {name: limit(*(v for v in values if v is not None)) for name, values in pairs.items()}


@dataclass(frozen=True, kw_only=True)
class ModelError(Bounded):
    """A stiffness by the optimiser's model."""

    cell_mm: float
    cells_through_web: float


def model_errors(scene: Scene, through_web: Sequence[int] = CELLS_THROUGH_WEB) -> Iterator[ModelError]:
    """Errors of the optimiser's model of a scene's web, without fillets, on finer and finer cells."""
    sharp = without_fillets(scene)
    true, thickness = evaluated(sharp), sharp.web.thickness_mm
    for count in through_web:
        with double_precision():
            own = own_model(sharp, thickness / count)
        bounds = model_error_percent(sharp, own.cell_mm)
        for name, value in own.stiffness.items():
            error = 100 * (value / true[name] - 1)
            yield ModelError(
                design=scene.name,
                quantity=name,
                bound_percent=bounds[name],
                error_percent=error,
                cell_mm=own.cell_mm,
                cells_through_web=thickness / own.cell_mm,
            )


def volume_error(scene: Scene, cell_mm: float) -> float:
    """Volume of the throw on cells over its closed form, less 1; without fillets and roundings."""
    sharp = without_fillets(scene)
    domain = build_domain(sharp, cell_mm, "web")
    filled = float((domain.passive_fraction * domain.volume_mm3).sum()) / domain.symmetry_fraction / 2
    return filled / half_throw_volume_mm3(sharp) - 1


def solid_error(scene: Scene) -> float:
    """Volume of the exact solid of the half throw over its closed form, less 1; as `volume_error`."""
    sharp = without_fillets(scene)
    with cad_session("volume") as gmsh:
        found = solid_properties(gmsh.model.occ, add_half_throw(gmsh.model.occ, sharp))
    return found.volume_mm3 / half_throw_volume_mm3(sharp) - 1


def every_feature() -> dict[str, Scene]:
    """The Mikron with every kind of feature that changes its volume."""
    mikron = load_scene("mikron-iiic-plain")
    bevels = [
        {"face": "pin", "y_mm": -6.0, "depth_mm": 12.0, "crown_mm": 2.5},
        {"face": "journal", "y_mm": 52.0, "depth_mm": 8.0},
    ]
    slot = {"shape": "side", "y_mm": 24.0, "length_mm": 16.0, "height_mm": 5.0, "depth_mm": 6.0}
    slot |= {"offset_mm": -1.5, "draft_deg": 15.0}
    cut = {"outline": "rectangle", "thickness_mm": 19.0, "width_mm": 60.0, "overhang_mm": 30.0}
    filleted = weighted(roomy_scene(mikron), {**PLAIN, "fillet_mm": 4.0})
    return {
        "no feature": mikron,
        **featured(),
        "filleted counterweight": filleted,
        "bevels": scene_with_web(mikron, {**cut, "bevel": bevels}),
        "sloped side pockets": scene_with_web(mikron, {**cut, "pocket": [slot]}),
    }


def featured() -> dict[str, Scene]:
    """The Mikron with counterweights and oil drillings, one of which breaks its lateral symmetry."""
    roomy = roomy_scene(load_scene("mikron-iiic-plain"))
    leaning, straight = (_drilled(*ends) for ends in ((160.0, 1.0, 15.0, 2.0), (180.0, 6.0, 0.0, 6.0)))
    return {
        "counterweight": weighted(roomy, PLAIN),
        "thin counterweight": weighted(roomy, THIN),
        "drilling": straight,
        "leaning drilling": leaning,
    }


def _drilled(main_deg: float, main_mm: float, pin_deg: float, pin_mm: float) -> Scene:
    ends = (("from", "main_journal", main_deg, main_mm), ("to", "crankpin", pin_deg, pin_mm))
    drilling = {key: {"on": on, "angle_deg": deg, "place_mm": mm} for key, on, deg, mm in ends}
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["throw"]["drilling"] = [{**drilling, "diameter_mm": 5.0}]
    return scene_from_dict(data)


def variants() -> dict[str, Scene]:
    """Eleven webs of the Mikron, without fillets, on one grid."""
    hole = {"shape": "cylinder", "x_mm": 0.0, "y_mm": 24.0, "diameter_mm": 12.0}
    slot = {"shape": "side", "y_mm": 24.0, "length_mm": 24.0, "height_mm": 7.0, "depth_mm": 8.0}
    box = {"shape": "box", "face": "pin", "x_mm": 0.0, "y_mm": -18.0, "size_x_mm": 30.0, "size_y_mm": 8.0}
    ellipse = {"outline": "ellipse", "semi_axis_throw_mm": 56.0, "semi_axis_lateral_mm": 36.0}
    tapered = {"outline": "tapered", "main_radius_mm": 31.0, "pin_radius_mm": 25.0}
    obround = {"outline": "obround"}
    rectangle = {"outline": "rectangle", "overhang_mm": 26.0, "corner_radius_mm": 8.0}
    webs: dict[str, dict[str, Any]] = {
        "obround 46": {**obround, "width_mm": 46.0},
        "obround 50": {**obround, "width_mm": 50.0},
        "obround 54": {**obround, "width_mm": 54.0},
        "obround 60": {**obround, "width_mm": 60.0},
        "rectangle 50": {**rectangle, "width_mm": 50.0},
        "rectangle 56": {**rectangle, "width_mm": 56.0},
        "ellipse": ellipse,
        "tapered": tapered,
        "obround 54 with hole": {**obround, "width_mm": 54.0, "pocket": [hole]},
        "obround 60 with slots": {**obround, "width_mm": 60.0, "pocket": [slot]},
        "obround 60 with recess": {**obround, "width_mm": 60.0, "pocket": [{**box, "depth_mm": 5.0}]},
    }
    return {name: _variant(web) for name, web in webs.items()}


def _variant(web: dict[str, Any]) -> Scene:
    data = mikron_with(fillet_mm=0.0).model_dump(mode="json", exclude_none=True)
    return scene_from_dict({**data, "web": {"thickness_mm": 19.0, **web}})


@dataclass(frozen=True)
class Ranking:
    """Both stiffnesses of all variants by both models, and rank agreement (Kendall, Spearman) of each."""

    own: dict[str, dict[str, float]]
    evaluated: dict[str, dict[str, float]]

    def agreement(self, quantity: str) -> tuple[float, float]:
        """Kendall's tau and Spearman's rho."""
        from scipy.stats import kendalltau, spearmanr

        pairs = [(self.own[name][quantity], self.evaluated[name][quantity]) for name in self.own]
        own, true = zip(*pairs, strict=True)
        return float(kendalltau(own, true).statistic), float(spearmanr(own, true).statistic)


def ranking(
    cell_mm: float = 1.5, steps: Sequence[int] = (3, 2), progress: Callable[[str], None] = lambda _: None
) -> Ranking:
    """All variants by both models; the cells are those of the Mikron's envelope."""
    own, true = {}, {}
    grid = build_domain(load_scene("mikron-iiic-plain"), cell_mm).grid
    for name, scene in variants().items():
        with double_precision():
            own[name] = own_model(scene, cell_mm, grid).stiffness
        true[name] = evaluated(scene, steps)
        cells = [
            f"{own[name][q] / 1e3:.2f} | {true[name][q] / 1e3:.2f} | "
            f"{100 * (own[name][q] / true[name][q] - 1):+.2f}"
            for q in ("torsion", "bending")
        ]
        progress(f"| {name} | {' | '.join(cells)} |")
    return Ranking(own, true)
