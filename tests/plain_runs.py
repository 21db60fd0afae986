"""Runs and loops without what takes longer than the few iterations and steps that they are about."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from cranktopo.tasks.optimise.picture import RunPictures


@contextmanager
def plain_runs() -> Iterator[None]:
    """Inside, runs of this process prove no bound, draw no picture and write no page: others show them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("cranktopo.tasks.optimise.finalise.run_pictures", lambda *_: RunPictures(b"", b""))
        patch.setattr("cranktopo.base.companion.usable_cores", lambda: 1)
        patch.setattr("cranktopo.tasks.optimise.finalise.run_page", lambda *_: None)
        patch.setattr("cranktopo.tasks.optimise.finalise.write_report", lambda *_: None)
        patch.setattr("cranktopo.tasks.optimise.finalise.cells_of_bound", lambda *_: None)
        yield


@contextmanager
def plain_loops() -> Iterator[None]:
    """Inside, loops of this process write no page and draw no plot of their steps: others show them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("cranktopo.tasks.iterate.loop._write_page", lambda *_: None)
        patch.setattr("cranktopo.tasks.iterate.loop.save_steps_plot", lambda *_: None)
        yield
