"""Where an output cannot go is said before the work, and nothing is written by asking."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.runs.destination import check_file, check_folder


@pytest.mark.parametrize(
    ("name", "replace", "words"),
    [
        ("a.txt", True, r"^--out '.*a\.txt': must end in \.png or \.svg\. Name it a\.png\.$"),
        ("none/a.png", True, r"its folder does not exist"),
        ("folder.png", True, r"folder\.png': is a folder"),
        ("taken.png", False, r"^--out '.*taken\.png' exists\. Give --force to replace it\.$"),
    ],
)
def test_files(tmp_path: Path, name: str, replace: bool, words: str) -> None:
    (tmp_path / "folder.png").mkdir()
    (tmp_path / "taken.png").write_text("mine", encoding="utf-8")
    with pytest.raises(CranktopoError, match=words) as told:
        check_file(tmp_path / name, "--out", (".png", ".svg"), replace)
    assert told.value.code == ExitCode.USAGE
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder.png", "taken.png"]


def test_what_can_be_written_passes(tmp_path: Path) -> None:
    (tmp_path / "taken.PNG").write_text("mine", encoding="utf-8")
    check_file(tmp_path / "taken.PNG", "--out", (".png",))
    check_file(tmp_path / "new", "--out", replace=False)
    check_folder(tmp_path)
    check_folder(tmp_path / "new" / "folder")
    assert [path.name for path in tmp_path.iterdir()] == ["taken.PNG"]


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_without_permission(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(CranktopoError, match="not writable"):
        check_file(tmp_path / "a", "--out")
    with pytest.raises(CranktopoError, match="not writable"):
        check_folder(tmp_path / "a")


def test_a_file_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    for folder in ("file", "file/folder"):
        with pytest.raises(CranktopoError, match=r"'.*file' is a file"):
            check_folder(tmp_path / folder)
