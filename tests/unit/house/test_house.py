"""The counts that describe a source tree, on one small enough to count by hand."""

from __future__ import annotations

from pathlib import Path

from tests.studies import walk
from tests.studies.house import counts

FILES = {
    "__init__.py": "",
    "base/bounds.py": "class Case: ...\n",
    "base/frame.py": """
LIMIT, _OWN = 1, 2
def solve(info: dict[str, Any]) -> float:
    'What it is.'
    return info["a"]["b"] + info[0]
""",
    "tasks/boundary_page.py": """
Row = dict[str, Any]
def late(row: Row) -> None:
    from ..base import frame
@dataclass(frozen=True)
class Case:
    'A case.'
def solve(progress: Literal["c"]): row["c"]
""",
    "tasks/any.py": "def f(unbalance, balancer, balance, balanced, left_balance): ...\n",
    "app.py": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from cranktopo.tasks import any\n",
}


def counted(root: Path, **changed: str) -> dict[str, str]:
    for name, text in (
        FILES | {f"{key}.py".replace("__", "/"): text for key, text in changed.items()}
    ).items():
        (root / "cranktopo" / name).parent.mkdir(parents=True, exist_ok=True)
        (root / "cranktopo" / name).write_text(text, encoding="utf-8")
    return counts(root)


def test_names_and_style(tmp_path: Path) -> None:
    found = counted(tmp_path)
    assert (found["files"], found["folders"], found["functions"]) == ("6", "3", "4")
    assert (found["classes"], found["class names in several modules"]) == ("2", "1")
    assert (found["public names"], found["public function names in several modules"]) == ("8", "1")
    assert (found["string subscripts"], found["string subscripts in report code"]) == ("3", "1")
    assert found["dict[str, Any] in annotations"] == "1"
    assert found["dict[str, Any] in annotations by another name"] == "1"
    assert (found["parameters called info"], found["parameters called progress"]) == ("1", "1")
    assert found["docstrings that begin like a question"] == "1"
    assert found["dataclasses, frozen of all"] == "1 of 1"


def test_topics(tmp_path: Path) -> None:
    found = counted(tmp_path)
    assert (found["bound: where"], found["balance: where"], found["vibration: where"]) == (
        "base 1",
        "tasks 1",
        "",
    )


def test_rooms_above_each_other(tmp_path: Path) -> None:
    found = counted(tmp_path)
    assert (found["rooms"], found["floors"], found["arrows between rooms"]) == ("3", "3", "2")
    assert (found["circles between rooms"], found["arrows between rooms that point up"]) == ("0", "0")


def test_a_circle_of_rooms(tmp_path: Path) -> None:
    found = counted(tmp_path, base__late="def f():\n    import cranktopo.app\n")
    assert (found["floors"], found["arrows between rooms"]) == ("1", "3")
    assert (found["circles between rooms"], found["arrows between rooms that point up"]) == ("1", "1")


WALKED = {
    "tasks/stage.py": """
from cranktopo.tasks.parts import part, Made
def optimise_design():
    own()
    part(own(), late(1))
def own():
    from cranktopo.base.tool import tool
    tool()
def late(x): ...
""",
    "tasks/parts.py": "class Made: ...\ndef part(*x): Made(), deep()\ndef deep(): far()\ndef far(): ...\n",
    "base/tool.py": "def tool(): ...\n",
}


def test_a_walk_opens_files_in_reading_order(tmp_path: Path) -> None:
    """`own`, `tool`, back into another room, `part`, `Made`, `deep`, and back; `late` is in the file."""
    for name, text in WALKED.items():
        (tmp_path / "cranktopo" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "cranktopo" / name).write_text(text, encoding="utf-8")
    assert list(walk.counts(tmp_path).values()) == [3, 7, 2, 1]
