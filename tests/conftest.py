from __future__ import annotations

from collections.abc import Iterator

import pytest

from cranktopo.fem.precision import double_precision
from cranktopo.scene import Scene, load_scene


@pytest.fixture(scope="session")
def mikron() -> Scene:
    return load_scene("mikron-iiic")


@pytest.fixture
def float64() -> Iterator[None]:
    with double_precision():
        yield
