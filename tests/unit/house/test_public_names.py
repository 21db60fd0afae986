"""The Python interface: what `import cranktopo` offers."""

from __future__ import annotations

import inspect
import re
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


FUNCTIONS = [name for name in cranktopo.__all__ if inspect.isfunction(getattr(cranktopo, name))]


OTHER_MEANING = {"compare": "baseline", "checked_surface": "design"}
"""A row's name, and densities."""


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_design_may_be_a_scene_a_path_or_a_name(name: str) -> None:
    for parameter in inspect.signature(getattr(cranktopo, name)).parameters.values():
        if parameter.name in (
            "scene",
            "design",
            "target",
            "targets",
            "names",
            "baseline",
            "reference",
            "run",
        ):
            kinds = str(parameter.annotation)
            of_bodies = parameter.name == "design" and "str | None" in kinds  # the design of a CAD file
            position = parameter.name == "baseline" and "int" in kinds
            wide = "DesignLike" in kinds or "TargetLike" in kinds or "str | Path" in kinds
            assert wide or of_bodies or position or name in OTHER_MEANING, (parameter.name, kinds)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_what_is_returned_is_public(name: str) -> None:
    """Or plain Python, arrays and frames."""
    kinds = set(re.findall(r"[A-Z]\w+", str(inspect.signature(getattr(cranktopo, name)).return_annotation)))
    assert kinds <= {*cranktopo.__all__, "None", "Path", "Iterator", "DataFrame", "Settings", "ShapeSettings"}
