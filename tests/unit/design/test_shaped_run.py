"""A run of `shape` is a design and a target like any other."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import designs_folder, load_scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.runs.manifest import new_manifest
from cranktopo.tasks.throw_fea.targets import resolve_target
from tests.cli.test_comparison_report import invented

PLAIN = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")


def shaped(folder: Path, finished: bool = True) -> Path:
    folder.mkdir(parents=True)
    (folder / "web.toml").write_text(PLAIN.replace('name = "mikron-iiic-plain"', 'name = "best-web"'))
    data = load_scene("mikron-iiic-plain").model_dump(mode="json")
    manifest = new_manifest(
        run="best", design="mikron-iiic-plain", command=("shape",), scene=data, options={}, inputs={}
    )
    (folder / "manifest.json").write_text(json.dumps(manifest.as_json()))
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


def test_commands_take_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """`compare best` and `export best` after `shape --out best`, with a web that is thinner."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("cranktopo.tasks.throw_fea.stage.evaluate", invented)
    web = shaped(tmp_path / "best") / "web.toml"
    web.write_text(web.read_text().replace("thickness_mm = 19.0", "thickness_mm = 17.0"))
    assert main(["compare", "best", "--baseline", "mikron-iiic-plain", "--format", "json"]) == 0
    names = [one["target"] for one in json.loads(capsys.readouterr().out)["evaluations"]]
    assert names == ["mikron-iiic-plain", "best-web"]
    assert main(["export", "best", "web.step", "--part", "web"]) == 0
    thin, thick = (throw_balance(load_scene(name)).web_kg for name in ("best", "mikron-iiic-plain"))
    assert thin / thick == pytest.approx(17 / 19, rel=1e-6)
    volume_mm3 = float(capsys.readouterr().out.split(" mm3")[0].split()[-1].replace(",", ""))
    assert 7.85e-6 * volume_mm3 == pytest.approx(thin, rel=1e-4)


def test_an_unfinished_one_is_refused(tmp_path: Path) -> None:
    folder = shaped(tmp_path / "best", finished=False)
    with pytest.raises(CranktopoError, match="is a run, not a design"):
        load_scene(str(folder))
