"""Fixtures of the sweeps: a scheduler of this process, a trace of computed points."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.sweep_cases import TRACE


@pytest.fixture(scope="module")
def scheduler() -> Iterator[str]:
    """A Dask scheduler with two workers in this process: what costs least to start."""
    import logging

    from distributed import LocalCluster

    with (
        LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            processes=False,
            protocol="tcp",
            dashboard_address="127.0.0.1:0",
            silence_logs=logging.CRITICAL,
        ) as cluster,
        pytest.MonkeyPatch.context() as patched,
    ):
        patched.setattr("cranktopo.tasks.sweep.executor._FIRST_S", 600.0)  # it is there: others work too
        yield cluster.scheduler_address


@pytest.fixture
def trace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """File with a line for every point that was computed."""
    path = tmp_path / "trace"
    path.touch()
    monkeypatch.setenv(TRACE, str(path))
    return path
