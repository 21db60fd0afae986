"""The density optimisation of a scene as equations: model, density-to-modulus chain, weights, target."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cranktopo.domain.build import Domain
from cranktopo.fem.model import ThrowModel, build_model
from cranktopo.fem.multigrid import Precision
from cranktopo.loads.cases import LoadCase
from cranktopo.optimise.forging_constraint import open_cells
from cranktopo.optimise.material import Interpolation, build_interpolation
from cranktopo.scene.schema import Scene

# The error of a compliance is the square of the residual's: a loose solve, started from the last design's
# displacements, leads to the same design in half the cycles. The final design is assessed at 1e-8.
TOLERANCE, TOLERANCE_EARLY = 1e-3, 1e-2


@dataclass(frozen=True)
class SolverSettings:
    """How exactly the linear systems of the design iterations are solved.

    Attributes:
        tolerance_early: relative residual before the last projection stage.
        plain: hexahedra without incompatible modes.
    """

    tolerance_early: float = TOLERANCE_EARLY
    tolerance: float = TOLERANCE
    precision: Precision = "float32"
    plain: bool = False


@dataclass(frozen=True)
class DensityProblem:
    """Everything constant during an optimisation.

    Attributes:
        target: volume fraction of the design space.
    """

    model: ThrowModel
    chain: Interpolation
    weights: tuple[float, ...]
    target: float
    max_iterations: int
    solving: SolverSettings = SolverSettings()


def build_problem(
    scene: Scene, domain: Domain, cases: Sequence[LoadCase], solving: SolverSettings | None = None
) -> DensityProblem:
    """The optimisation problem of a scene on a domain; call inside `double_precision()`."""
    solving = solving or SolverSettings()
    settings = scene.optimise
    weights = {name: getattr(settings.weights, name) for name in type(settings.weights).model_fields}
    return DensityProblem(
        model=build_model(scene, domain, cases, plain=solving.plain),
        chain=build_chain(scene, domain),
        weights=tuple(weights[case.kind] for case in cases),
        target=settings.volume_fraction,
        max_iterations=settings.max_iterations,
        solving=solving,
    )


def build_chain(scene: Scene, domain: Domain) -> Interpolation:
    """The density-to-modulus chain of a scene on a domain; call inside `double_precision()`."""
    radius = scene.optimise.filter_radius_mm or default_filter_radius_mm(domain)
    die = scene.effects.manufacturing_constraint == "on"
    return build_interpolation(domain, radius, open_cells(scene, domain) if die else None)


def default_filter_radius_mm(domain: Domain) -> float:
    """Filter radius when the scene gives none: 2.5 cells, and never below 3 mm."""
    return max(3.0, 2.5 * domain.grid.largest_edge_mm)
