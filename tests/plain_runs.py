"""Runs of the density optimisation without what takes longer than their few iterations."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest


@contextmanager
def plain_runs() -> Iterator[None]:
    """Inside, runs of this process draw no picture and write no page: those of another test show both."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("cranktopo.tasks.optimise.finalise.save_run_picture", lambda *_: None)
        patch.setattr("cranktopo.tasks.optimise.finalise.run_page", lambda *_: None)
        patch.setattr("cranktopo.tasks.optimise.finalise.write_report", lambda *_: None)
        yield
