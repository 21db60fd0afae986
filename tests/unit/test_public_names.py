"""The Python interface: what `import cranktopo` offers, and the README's examples as they stand."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from operator import attrgetter
from pathlib import Path

import pytest

import cranktopo

README = Path(__file__).resolve().parents[2] / "README.md"


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


def test_examples_of_the_readme_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """One after the other in one namespace, as in a notebook; what they print is what the README shows."""
    blocks = re.findall(r"^```python\n(.*?)^```", README.read_text(encoding="utf-8"), re.M | re.S)
    assert len(blocks) >= 2
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, "README.md", "exec"), names)
        shown = re.findall(r"(?m)^# (.*)$", block)
        printed = capsys.readouterr().out.splitlines()
        assert printed == shown
    assert (tmp_path / "web.stl").is_file()
