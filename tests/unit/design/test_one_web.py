"""One of two different webs as a design of its own, and two found webs back on one throw."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import redirected
from cranktopo.design.assumed import THROW, assumptions
from cranktopo.design.halves import difference, halves
from cranktopo.design.idle_keys import idle_keys
from cranktopo.design.loading import load_scene, one_web, parse_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.design.writing import pair_text, toml_text
from cranktopo.tasks.designs.run_webs import web_target
from tests.physics.fea.test_two_webs import ACROSS, SECOND, WEB, lopsided, scene_with

DRILLED: dict[str, Any] = {
    "drilling": [{**ACROSS, "web": "second", "to": {"on": "crankpin", "angle_deg": 10.0, "place_mm": 9.0}}]
}


def named(scene: Scene, name: str) -> Scene:
    return scene.model_copy(update={"name": name})


def test_each_web_is_a_throw_of_two_such_webs() -> None:
    """As a user would write it; the drilling of that half is in both of it."""
    scene = scene_with(DRILLED, second_web=SECOND)
    first, second = one_web(scene, "first"), one_web(scene, "second")
    assert first.throw.drilling == ()
    written = {**DRILLED["drilling"][0], "web": "both"}
    expected = scene_with({"drilling": [written], "mirrored_web": "second"}, web=SECOND)
    assert second == named(expected, "mikron-iiic-plain-second-web")
    assert not difference(first)
    assert not difference(second)
    assert [str(item) for item in assumptions(second, (THROW,))][-1] == (
        "throw.mirrored_web = second (the half beyond the crankpin is taken as its mirror image)"
    )


def test_it_survives_its_file() -> None:
    """Of the scene that a run writes the same is assumed as of the run."""
    again = parse_scene(toml_text(one_web(lopsided(), "first"), "web"))
    assert "throw.mirrored_web" in [item.key for item in assumptions(again, (THROW,))]


def test_equal_halves_stay_the_scene_itself() -> None:
    scene = load_scene("mikron-iiic-plain")
    assert one_web(scene, None) is scene


REFUSED: dict[str, tuple[Scene, Any, str, ExitCode]] = {
    "unnamed": (lopsided(), None, "second_web: the halves of the throw differ", ExitCode.INVALID_INPUT),
    "alike": (
        load_scene("mikron-iiic-plain"),
        "first",
        "--web first: both halves of the throw are alike",
        ExitCode.USAGE,
    ),
    "original": (
        scene_with(second_web=SECOND, original={"file": "old.step"}),
        "second",
        "original.file is one half throw, the first one",
        ExitCode.INVALID_INPUT,
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused(case: str) -> None:
    scene, web, message, code = REFUSED[case]
    with pytest.raises(CranktopoError) as caught:
        one_web(scene, web)
    assert message in str(caught.value)
    assert caught.value.code == code


def test_each_half_has_its_own_original(tmp_path: Path) -> None:
    """The body of the first web, and that of the other by a key of its own; of the halves each is `file`."""
    scene = scene_with(second_web=SECOND, original={"file": "one.step", "second_file": "two.step"})
    for web, file in (("first", "one.step"), ("second", "two.step")):
        half = one_web(scene, web)
        assert half.original is not None
        assert (half.original.file, half.original.second_file) == (file, None)


def test_a_search_takes_the_worse_web_and_says_so() -> None:
    """Of webs of 19 and 21 mm the thinner one, whichever side it lies on."""
    thick = {**SECOND, "thickness_mm": 21.0}
    notes: list[str] = []
    with redirected(notes.append):
        taken = web_target(scene_with(second_web=thick), worse=True).design
    assert taken.throw.mirrored_web == "first"
    assert "the first web is taken, which bends more; --web second takes the other" in notes[-1]


def written(scene: Scene, path: Path) -> str:
    path.write_text(toml_text(scene, "two webs"), encoding="utf-8")
    return str(path)


def paired(tmp_path: Path, scene: Scene, **webs: Scene) -> Scene:
    text = pair_text(written(scene, tmp_path / "two.toml"), tmp_path / "pair.toml", **webs)
    return parse_scene(text, whole=True)


def test_both_webs_go_back_to_where_they_came_from(tmp_path: Path) -> None:
    scene = lopsided()
    pair = paired(tmp_path, scene, first=one_web(scene, "first"), second=one_web(scene, "second"))
    assert pair.name == "pair"
    assert halves(named(pair, scene.name)) == halves(scene)


def test_a_pair_has_no_key_that_nobody_gave(tmp_path: Path) -> None:
    """A run stores its scene with every key: the face of a counterweight as thick as its web, empty lists."""
    own = scene_with(web={**WEB, "counterweight": {"outer_radius_mm": 34.0, "half_angle_deg": 70.0}})
    stored = scene_from_dict(own.model_dump(mode="json"))
    design = written(own, tmp_path / "two.toml")
    text = pair_text(design, tmp_path / "pair.toml", first=stored, second=stored)
    data = tomllib.loads(text)
    assert data["second_web"]["counterweight"] == {"outer_radius_mm": 34.0, "half_angle_deg": 70.0}
    assert idle_keys(parse_scene(text, whole=True), data) == ()
    assert halves(parse_scene(text, whole=True))[1].web == own.web


def test_a_web_brings_the_lengths_of_its_journals(tmp_path: Path) -> None:
    """A thicker web on shorter bearings replaces the second one; the first half stays as it is."""
    scene = lopsided()
    own = scene.throw.main_journal.model_dump(exclude_none=True)
    other = scene_with({"main_journal": {**own, "length_mm": 36.0}}, web={**WEB, "thickness_mm": 23.0})
    near, far = halves(paired(tmp_path, scene, second=other))
    assert (near.web, near.throw.main_journal.length_mm) == (scene.web, 40.0)
    assert (far.web, far.throw.main_journal.length_mm) == (other.web, 36.0)
    assert far.throw.crankpin.length_mm == other.throw.crankpin.length_mm


def test_another_throw_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CranktopoError, match=r"--second: its throw.radius_mm is .*, that of the design 48"):
        paired(tmp_path, lopsided(), second=load_scene("opposed-piston"))
