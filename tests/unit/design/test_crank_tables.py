"""The tables of the whole crank: what is refused, and in which words."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.loading import load_scene, parse_scene, scene_from_dict
from cranktopo.design.scene_files import input_files
from cranktopo.design.schema import Scene
from cranktopo.design.writing import copy_of, toml_text
from tests.engine_arrangements import MIKRON

PLAIN = "kind = 'cylinder'\nlength_mm = 9.0\ndiameter_mm = 20.0\n"
STEP = "[[crank.end]]\nside = 'free'\n[[crank.end.step]]\n"


def read(crank: str, folder: Path | None = None) -> Scene:
    return parse_scene(f"{MIKRON}\n{crank}", folder=folder)


def journal(**keys: Any) -> str:
    return "[[crank.main_journal]]\n" + "\n".join(f"{key} = {value}" for key, value in keys.items()) + "\n"


@pytest.mark.parametrize(
    ("crank", "message"),
    [
        ("[crank]\nthrows = ['throw', 'throw']", r"crank\.throws = .*names 2 throws; the engine has 4"),
        (journal(number=5), r"crank\.main_journal\[0\]\.number = 5: must be >= 0 and <= 4"),
        (journal(number=1) * 2, r"crank\.main_journal\[1\]\.number = 1: is there twice"),
        ("[[crank.end]]\nside = 'free'\n" * 2, r"crank\.end\[1\]\.side = 'free': that end is given twice"),
        ("[[crank.end]]\nside = 'rear'", r"crank\.end\[0\]\.side = 'rear': must be 'free' or 'output'"),
        (f"{STEP}kind = 'plug'", r"crank\.end\[0\]\.step\[0\]\.kind = 'plug': unknown choice"),
        (
            f"{STEP}kind = 'cone'\nlength_mm = 9.0",
            r"crank\.end\[0\]\.step\[0\]\.cone\.|outer_end_diameter_mm",
        ),
        (
            f"{STEP}kind = 'cylinder'\nlength_mm = 9.0\ndiameter_mm = 20.0\nbore_diameter_mm = 20.0",
            r"bore_diameter_mm = 20\.0: must be smaller than the step's diameter of 20 mm",
        ),
        (
            f"{STEP}kind = 'keyway'\nlength_mm = 9.0\ndiameter_mm = 20.0\nwidth_mm = 6.0\ndepth_mm = 0.2",
            r"depth_mm = 0\.2: must be > 0\.4606 and < 10 mm",
        ),
        (
            f"{STEP}kind = 'flange'\nlength_mm = 9.0\ndiameter_mm = 80.0\nbolts = 30\nbolt_circle_mm = 60.0\n"
            "bolt_diameter_mm = 8.0",
            r"bolts = 30: that many holes meet each other",
        ),
        (
            f"{STEP}kind = 'flange'\nlength_mm = 9.0\ndiameter_mm = 80.0\nbolts = 6\nbolt_circle_mm = 76.0\n"
            "bolt_diameter_mm = 8.0",
            r"bolt_circle_mm = 76\.0: holes of 8 mm must lie between",
        ),
        (f"{STEP}kind = 'cylinder'\nlength_mm = 9.0\ndiameter_mm = 0.06", r"diameter_mm = 0\.06: must be >="),
        (
            f"{STEP}{PLAIN}[[crank.end.step]]\nbore_diameter_mm = 8.0\n{PLAIN}[[crank.end.step]]\n{PLAIN}",
            r"step\[1\]\.bore_diameter_mm = 8.*is a closed hollow that no tool reaches.*from outside",
        ),
        (
            journal(number=2, outer_diameter_mm=52.0),
            r"throw 2 of the crank: throw\.second_main_journal\..*shoulder",
        ),
    ],
)
def test_refused(crank: str, message: str) -> None:
    with pytest.raises(CranktopoError, match=message):
        read(crank)


def test_two_lengths_of_a_second_journal_are_refused() -> None:
    text = MIKRON.replace(
        "[throw.main_journal]", "second_main_journal_length_mm = 44.0\n[throw.main_journal]"
    )
    second = "[throw.second_main_journal]\nouter_diameter_mm = 44.0\nlength_mm = 40.0\n"
    with pytest.raises(CranktopoError, match="has a length of its own"):
        parse_scene(text.replace("[web]", f"{second}[web]"), whole=True)


def test_a_pitch_beside_different_throws_is_refused() -> None:
    pitch = "[engine.arrangement]\ncylinder_pitch_mm = 114.0\n"
    with pytest.raises(CranktopoError, match="are the distances of the cylinders"):
        read(pitch + journal(number=2, length_mm=44.0))


def test_a_main_journal_of_its_own_is_on_both_sides() -> None:
    throws = throw_scenes(read(journal(number=2, length_mm=44.0)))
    assert [throw.pitch_mm for throw in throws] == [114.0, 116.0, 116.0, 114.0]
    second = throws[1].throw.second_main_journal
    assert second is not None
    assert second.length_mm == throws[2].throw.main_journal.length_mm == 44.0
    assert second.outer_diameter_mm == 42.0


@pytest.mark.parametrize("shaped", ["recess_mm", "fillet_axial_mm"])
@pytest.mark.parametrize(
    ("own", "bearings"), [({"length_mm": 0.0}, [0, 2, 3, 4]), ({"fillet_mm": 0.0}, "every")]
)
def test_a_sharp_main_journal_has_no_recess_or_ellipse(
    shaped: str, own: dict[str, float], bearings: Any
) -> None:
    """A flying web, and a journal whose fillet is left out, beside journals whose fillets have a shape."""
    given = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    given["throw"]["main_journal"] |= {"fillet_mm": 1.0, shaped: 0.6}
    given["crank"] = {"bearings": bearings, "main_journal": [{"number": 1, **own}]}
    first, second, *_ = throw_scenes(scene_from_dict(given, whole=True))
    beside = first.throw.second_main_journal
    assert beside is not None
    for sharp in (beside, second.throw.main_journal):
        assert (sharp.fillet_mm, sharp.fillet_axial_mm, sharp.recess_mm) == (0.0, None, None)
    assert getattr(first.throw.main_journal, shaped) == 0.6


def test_a_throw_of_another_file_has_its_web_on_the_journals_of_the_crank(tmp_path: Path) -> None:
    other = MIKRON.replace("thickness_mm = 19.0", "thickness_mm = 21.0").replace("42.0", "41.0", 1)
    (tmp_path / "other.toml").write_text(other, encoding="utf-8")
    scene = read("[crank]\nthrows = ['throw', 'other.toml', 'throw', 'throw']", tmp_path)
    throws = throw_scenes(scene)
    assert [throw.web.thickness_mm for throw in throws] == [19.0, 21.0, 19.0, 19.0]
    assert {throw.throw.main_journal.outer_diameter_mm for throw in throws} == {42.0}
    assert input_files(scene) == {"crank.throws[1]": tmp_path / "other.toml"}
    assert parse_scene(toml_text(scene, "read again")) == scene


def test_another_stroke_is_refused(tmp_path: Path) -> None:
    (tmp_path / "other.toml").write_text(MIKRON.replace("radius_mm = 48.0", "radius_mm = 50.0"))
    with pytest.raises(CranktopoError, match=r"its throw\.radius_mm is 50, that of the design 48 mm"):
        read("[crank]\nthrows = ['throw', 'other.toml', 'throw', 'throw']", tmp_path)


def test_a_copy_finds_the_files_of_the_crank(tmp_path: Path) -> None:
    (tmp_path / "other.toml").write_text(MIKRON, encoding="utf-8")
    crank = "[crank]\nthrows = ['throw', 'other.toml', 'throw', 'throw']\n"
    (tmp_path / "mine.toml").write_text(MIKRON + crank, encoding="utf-8")
    (tmp_path / "below").mkdir()
    copy = tmp_path / "below" / "copy.toml"
    copy.write_text(copy_of(str(tmp_path / "mine.toml"), copy), encoding="utf-8")
    own = load_scene(copy).crank
    assert own is not None
    assert own.throws == ("throw", str(tmp_path / "other.toml"), "throw", "throw")
