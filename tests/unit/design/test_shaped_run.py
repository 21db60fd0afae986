"""A run of `shape` is a design and a target like any other."""

from __future__ import annotations

from pathlib import Path

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import designs_folder, load_scene
from cranktopo.tasks.fea.targets import resolve_target

PLAIN = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")


def shaped(folder: Path, finished: bool = True) -> Path:
    folder.mkdir(parents=True)
    (folder / "web.toml").write_text(PLAIN.replace('name = "mikron-iiic-plain"', 'name = "best-web"'))
    (folder / "manifest.json").write_text("{}")
    if finished:
        (folder / "shape.json").write_text("{}")
    return folder


def test_its_folder_and_its_name_stand_for_its_web(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    folder = shaped(tmp_path / "best")
    shaped(tmp_path / "runs" / "20260101-120000_best_0123abcd")
    assert load_scene(str(folder)).name == "best-web"
    assert load_scene("20260101-12").name == "best-web"
    assert resolve_target("best").scene.name == "best-web"
    assert resolve_target("20260101-12").scene.name == "best-web"


def test_an_unfinished_one_is_refused(tmp_path: Path) -> None:
    folder = shaped(tmp_path / "best", finished=False)
    with pytest.raises(CranktopoError, match="is a run, not a design"):
        load_scene(str(folder))
