"""The Python interface: what `import cranktopo` offers."""

from __future__ import annotations

import inspect
import subprocess
import sys
from operator import attrgetter

import pytest

import cranktopo


@pytest.mark.parametrize("name", cranktopo.__all__)
def test_public_names_are_documented(name: str) -> None:
    found = getattr(cranktopo, name)
    assert found.__name__ == name
    assert len(inspect.getdoc(found) or "") > 10


def test_importing_the_package_loads_nothing() -> None:
    code = "import sys, cranktopo; print([m for m in sys.modules if m.startswith('cranktopo.')])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'optimize'"):
        attrgetter("optimize")(cranktopo)
