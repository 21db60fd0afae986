"""Second sheet of the drawing of a crank: its raw part, what it says, where it is left out."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import solver_error
from cranktopo.bodies.raw_crankshaft import raw_crank_mass_kg, raw_crank_volume_mm3
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.crank import drawn_crank_mass
from cranktopo.tasks.crank_drawing import sheet
from cranktopo.tasks.crank_drawing.crank_shape import crank_shape
from cranktopo.tasks.crank_drawing.raw_crank import raw_crank_figure, raw_crank_shape
from tests.cli.test_crank_drawing import DAY, overlaps, small, words

ENGINE = {"bore_mm": 80.0, "rod_length_mm": 130.0, "speed_rpm": 3000.0, "cylinders": 1}
STEP = {"kind": "cylinder", "diameter_mm": 30.0, "length_mm": 20.0}
FORGING = {"allowance_mm": 1.5, "draft_deg": 5.0, "flash_mm": 1.0}


def raw_scene() -> Scene:
    return small(engine=ENGINE, forging=FORGING, crank={"end": [{"side": "output", "step": [STEP]}]})


def test_it_shows_the_whole_raw_crank() -> None:
    scene = raw_scene()
    shape = crank_shape(scene)
    raw = raw_crank_shape(scene, shape)
    volume = sum(piece.solid.volume() for piece in raw.pieces)
    assert volume == pytest.approx(raw_crank_volume_mm3(scene), rel=5e-3)
    (start, end), half = raw.z_mm, scene.throw.main_journal.length_mm / 2
    assert start == pytest.approx(0.0, abs=1e-6)
    rise = (30.0 / 2 + 1.5 - 0.5) * 0.0874887  # of the end's face toward the flash line, tan 5 deg
    assert end == pytest.approx(scene.pitch_mm + half + 20.0 + 1.5 + rise, abs=1e-3)
    kg = drawn_crank_mass(scene).mass_kg
    figure, _ = raw_crank_figure(scene, shape, raw, DAY, kg)
    told = "\n".join(words(figure))
    for text in (
        f"raw {raw_crank_mass_kg(scene):.3f} kg, finished {kg:.3f} kg",
        f"length {end - start:.1f}",
        "allowance 1.5 on journals",
        "draft 5°",
        "flash 1, trimmed",
        "flash line, 0°",
        "output ⌀33",
        "MAIN JOURNAL ⌀47",
        "all throws lie in one parting plane",
        "web.pocket[0]",
        "2/2",
    ):
        assert text in told, text
    assert not overlaps(figure)


def test_a_picture_has_one_sheet_and_a_raw_crank_that_cannot_be_built_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def refused(*_: Any) -> None:
        raise solver_error("raw half throw: no.", "Change it.")

    monkeypatch.setattr("cranktopo.design.loading.load_scene", lambda *_, **__: raw_scene())
    monkeypatch.setattr("cranktopo.tasks.crank_drawing.sheet.raw_crank_shape", refused)
    shape = crank_shape(raw_scene())
    finished = sheet.crank_figure(raw_scene(), shape, DAY)
    monkeypatch.setattr("cranktopo.tasks.crank_drawing.sheet.crank_shape", lambda *_: shape)
    monkeypatch.setattr("cranktopo.tasks.crank_drawing.sheet.crank_figure", lambda *_: finished)
    assert main(["drawing", "small", str(tmp_path / "crank.svg")]) == 0
    assert "a .svg file has one sheet, without the raw crank: a .pdf has both" in capsys.readouterr().err
    assert main(["drawing", "small", str(tmp_path / "crank.pdf")]) == 0
    assert "the drawing has no sheet of the raw crank: raw half throw: no." in capsys.readouterr().err
    assert pages(tmp_path / "crank.pdf") == 1


def pages(path: Path) -> int:
    return len(re.findall(rb"/Type /Page\b", path.read_bytes()))


@pytest.mark.slow
def test_a_pdf_has_two_pages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cranktopo.design.loading.load_scene", lambda *_, **__: raw_scene())
    assert main(["drawing", "small", str(tmp_path / "crank.pdf")]) == 0
    assert pages(tmp_path / "crank.pdf") == 2
