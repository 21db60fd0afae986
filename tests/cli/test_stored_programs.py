"""Compiled programs are kept: a second design on the same cells compiles nothing."""

from __future__ import annotations

from pathlib import Path

import jax
import pytest

from cranktopo.design.loading import load_scene
from cranktopo.tasks.optimise.stage import optimise_design
from tests.plain_runs import plain_runs

ASKED, FOUND = "/jax/compilation_cache/compile_requests_use_cache", "/jax/compilation_cache/cache_hits"


@pytest.fixture
def events() -> list[str]:
    """What JAX says of its stored programs from now on."""
    heard: list[str] = []
    jax.monitoring.register_event_listener(lambda event, **_: heard.append(event))
    return heard


@pytest.mark.slow
def test_a_second_design_on_the_same_cells_compiles_nothing(tmp_path: Path, events: list[str]) -> None:
    """Compiles what the cache has not: `pytest -m slow tests/cli/test_stored_programs.py`."""
    scene = load_scene("mikron-iiic-plain").with_optimise(
        resolution_mm=4.5, max_iterations=1, volume_fraction=0.3
    )
    with plain_runs():
        optimise_design(scene, tmp_path / "first")
        jax.clear_caches()
        events.clear()
        optimise_design(scene.with_optimise(volume_fraction=0.4), tmp_path / "second")
    assert events.count(FOUND) == events.count(ASKED)
    assert 0 < events.count(FOUND) < 100  # single operations would be more
