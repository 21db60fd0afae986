"""Description of a design and origins of its values, for those who ask for more lines."""

from __future__ import annotations

from collections.abc import Iterator

from cranktopo.design.checks.roller_bearings import roller_bearings
from cranktopo.design.schema import Scene


def origins(scene: Scene) -> tuple[str, ...]:
    """Return the description of a design, and the source of each of its materials and roller bearings."""
    described = (f"description: {scene.description}",) if scene.description else ()
    return (*described, *(f"{key}.source: {source}" for key, source in _sources(scene) if source))


def _sources(scene: Scene) -> Iterator[tuple[str, str]]:
    yield "material", scene.material.source
    if scene.rod is not None and scene.rod.material is not None:
        yield "rod.material", scene.rod.material.source
    if scene.balancer is not None and scene.balancer.material is not None:
        yield "balancer.material", scene.balancer.material.source
    yield from ((key, bearing.source) for key, bearing in roller_bearings(scene))
