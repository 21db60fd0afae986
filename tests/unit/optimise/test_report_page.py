"""What a report says and packs: verdict, scene3d, Markdown."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import trimesh

from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.design.goal.balance_moved import MovedBalance
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.page import Fact, Page, Section
from cranktopo.report.plot import picture
from cranktopo.report.report_file import write_markdown
from cranktopo.report.result_table import ResultTable
from cranktopo.report.viewer.scene3d import MOST_FACES, DesignSnapshot, Scene3D, ShownBody, packed
from cranktopo.tasks.extraction.result import WallMeasures
from cranktopo.tasks.extraction.text import length_lines
from cranktopo.tasks.optimise.result import RunMetrics
from cranktopo.tasks.optimise.run_record import MOST_CELLS, coarsened, evenly_spread
from cranktopo.tasks.optimise.text import facts, fatigue_fact, headline, run_summary, run_undercuts_fact
from cranktopo.tasks.throw_fea.quantities import worse_line
from tests.packed_scenes import unpacked
from tests.run_metrics import SURFACE, load_of, run_metrics


def mesh_of(body: trimesh.Trimesh) -> SurfaceMesh:
    return SurfaceMesh(np.asarray(body.vertices, np.float64), np.asarray(body.faces, np.int64))


def metrics(mass: float, torsion: float, bending: float) -> RunMetrics:
    """What a run holds after changes in percent of a web of 1 kg, 1 N m/rad and 1 N/mm."""

    def web(mass: float, torsion: float, bending: float) -> dict[str, Any]:
        stiffness = {"stiffness_Nm_per_rad": 1e5 * torsion}, {"stiffness_N_per_mm": 2e5 * bending}
        cases = {
            name: {**value, "compliance_N_mm": 1.0, "support": "free", "load": load_of(name)}
            for name, value in zip(("torsion", "bending"), stiffness, strict=True)
        }
        masses = {"throw": 2.0 * mass, "web": mass}
        return {"mass_kg": masses, "load_cases": cases, "stiffness_per_mass": {}}

    original = {**web(1, 1, 1), "gain_of_stiffness_per_mass_percent": {}}
    return run_metrics(
        **web(*(1 + change / 100 for change in (mass, torsion, bending))), original_web=original
    )


def test_headline_says_first_what_got_worse() -> None:
    assert headline(metrics(-45.0, -21.0, -9.9)) == (
        "The optimised throw is 21.0 % softer in torsion and 9.9 % softer in bending than the original; it "
        "is 45.0 % lighter."
    )
    assert headline(metrics(5.0, 0.0, 3.0)) == (
        "The optimised throw is 5.0 % heavier than the original; it is 3.0 % stiffer in bending."
    )
    assert headline(metrics(-7.3, 13.0, 3.4)) == (
        "The optimised throw is 7.3 % lighter, 13.0 % stiffer in torsion and 3.4 % stiffer in bending than "
        "the original."
    )
    assert headline(metrics(0.0, 0.01, -0.01)) == "The optimised throw is like the original."


MOVED = MovedBalance(balance_factor_percent=69.4, original_percent=50.2, told="a lighter one would do")


def test_a_balance_that_moved_is_said_first_and_has_a_card() -> None:
    """A V-twin with 69 % of its oscillating mass balanced instead of 50 was "2.7 % stiffer", no more."""
    found = metrics(0.0, 2.7, 1.1).model_copy(update={"balance": MOVED})
    assert headline(found).startswith(
        "Balance factor 69.4 % of the oscillating mass instead of 50.2 %. The optimised throw is 2.7 %"
    )
    record: Any = SimpleNamespace(metrics=found, fatigue=None, folder=Path("run"))
    (card,) = [fact for fact in facts(record) if fact.label == "Balance factor"]
    assert (card.value, card.note, card.status) == ("50 -> 69 %", MOVED.told, "bad")
    worse = "worse than the original web: balance factor 69.4 % of the oscillating mass instead of 50.2 %"
    assert run_summary(found, Path("run")).splitlines()[1] == worse
    assert RunMetrics.of_json(found.as_json(), "a run").balance == found.balance


def test_terminal_names_what_got_worse() -> None:
    changes = metrics(-45.0, -21.0, 5.0).changes_percent
    assert worse_line(changes, "the original web") == "worse than the original web: 21.0 % softer in torsion"
    assert worse_line(metrics(-1.0, 1.0, 1.0).changes_percent, "it") == ""


UNDRAFTED = {"released": True, "volume_mm3": 0.0, "without_draft": ["web.counterweight"]}


@pytest.mark.parametrize(
    ("surface", "value", "status", "words"),
    [
        ({"refusal": "too grey"}, "no", "bad", "no surface"),
        ({"cavities": 2}, "no", "bad", "2 closed hollows"),
        ({"cavities": 0}, "not checked", "unknown", "undercuts are possible"),
        ({"cavities": 0, "undercuts": {"released": True, "volume_mm3": 0.0}}, "yes", "good", "x = 0"),
        (
            {"cavities": 0, "undercuts": UNDRAFTED},
            "yes, too little draft",
            "neutral",
            "it; too little draft: web.counterweight",
        ),
        ({"cavities": 0, "undercuts": {"released": False, "volume_mm3": 41.6}}, "no", "bad", "42 mm3"),
        (
            {"cavities": 1, "undercuts": {"released": True, "volume_mm3": 0.0}},
            "no",
            "bad",
            "1 closed hollow ",
        ),
    ],
)
def test_release(surface: dict[str, Any], value: str, status: str, words: str) -> None:
    fact = run_undercuts_fact(run_metrics(surface=surface if "refusal" in surface else SURFACE | surface))
    assert (fact.value, fact.status) == (value, status)
    assert words in fact.note


def test_fatigue_of_the_design_beside_its_baseline() -> None:
    entries = [{"target": "old", "safety": 1.31}, {"target": "web", "safety": 0.97}]
    told = [SimpleNamespace(**entry) for entry in entries]
    found: Any = SimpleNamespace(baseline="old", fatigue=told, method="lsa")
    fact = fatigue_fact(found, "")
    note = "least safety of web; old has 1.31; it is below 1: by this method it fails"
    assert (fact.value, fact.status, fact.note) == ("0.97", "bad", note)
    found.baseline = None
    assert fatigue_fact(found, "").value == "1.31"
    assert fatigue_fact(None, "why not").note == "why not"


def test_packed_scene_is_the_body_and_the_densities() -> None:
    cone = trimesh.creation.cone(radius=9.0, height=31.0, sections=40)
    density = np.random.default_rng(3).random((4, 3, 2))
    grid = DensityGrid(np.array([1.0, 2.0, 3.0]), np.array([0.5, 1.5, 2.5]), density)
    header, arrays = unpacked(
        packed(
            Scene3D(
                (ShownBody("cone", mesh_of(cone), (10.0, 20.0), 31.0),), (DesignSnapshot(5, grid),), ("n",)
            )
        )
    )
    body = header["bodies"][0]
    share = arrays[body["positions"]].reshape(-1, 3) / 65535
    points = np.array(body["low_mm"]) + share * np.array(body["size_mm"])
    faces = arrays[body["faces"]].reshape(-1, 3)
    # But for the caps of the journals, which lie inside them, the faces are the body's.
    caps = (np.ptp(points[faces][:, :, 2], axis=1) < 1e-2) & (points[faces][:, 0, 2] > 1.0)
    np.testing.assert_allclose(mesh_volume(points, faces[~caps]), cone.volume, rtol=2e-3)
    journal = arrays[body["journal"]].astype(bool)
    heights = points[:, 2]
    assert (heights[journal] < 10.01).any()
    assert (heights[journal] > 19.99).any()
    assert not ((heights[journal] > 10.01) & (heights[journal] < 19.99)).any()
    assert ((heights[~journal] > 9.9) & (heights[~journal] < 20.1)).all()
    steps = header["steps"]
    assert (steps["shape"], steps["iterations"], steps["notes"]) == ([4, 3, 2], [5], ["n"])
    found = arrays[steps["densities"][0]].reshape(4, 3, 2) / 255
    np.testing.assert_allclose(found, density, atol=0.5 / 255)


def mesh_volume(points: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = np.moveaxis(points[faces], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def test_large_surfaces_are_simplified() -> None:
    sphere = trimesh.creation.icosphere(subdivisions=7, radius=40.0)
    assert len(sphere.faces) > 2 * MOST_FACES
    text = packed(Scene3D((ShownBody("sphere", mesh_of(sphere), (-50.0, 50.0), 40.0),)))
    header, arrays = unpacked(text)
    body = header["bodies"][0]
    faces = arrays[body["faces"]].reshape(-1, 3)
    assert len(faces) < 1.1 * MOST_FACES
    points = np.array(body["low_mm"]) + arrays[body["positions"]].reshape(-1, 3) / 65535 * np.array(
        body["size_mm"]
    )
    assert mesh_volume(points, faces) == pytest.approx(4 / 3 * np.pi * 40.0**3, rel=5e-3)


def test_steps_are_few_and_coarse_enough_and_keep_the_mass() -> None:
    assert evenly_spread(range(1, 200), 60)[0] == 1
    assert evenly_spread(range(1, 200), 60)[-1] == 199
    assert len(set(evenly_spread(range(1, 200), 60))) == 60
    assert evenly_spread([3, 4], 60) == [3, 4]
    density = np.random.default_rng(1).random((51, 40, 27))
    grid = DensityGrid(np.zeros(3), np.array([1.0, 2.0, 0.5]), density)
    coarse = coarsened(grid, 500)
    assert 500 * coarse.density.size < 1.3 * MOST_CELLS
    assert coarse.volume_mm3() == pytest.approx(grid.volume_mm3(), rel=1e-12)
    assert coarsened(grid, 1) is grid


def test_markdown_has_the_same_content(tmp_path: Path) -> None:
    rows = (
        {"design": "a", "mass_kg": 1.23456, "because": "x | y"},
        {"design": "b", "mass_kg": None, "because": "z"},
    )
    table = ResultTable({"design": 0, "mass_kg": 3, "because": 0}, rows)
    plot = picture("curve", "a straight line", lambda axes: axes.plot([0, 1]))
    section = Section("one", "First part", "Words.", (("Values", table),), (plot,))
    facts = (Fact("Mass", "1.2 kg", "less", "good"),)
    path = tmp_path / "web.md"
    write_markdown(Page("Title", "when", "Verdict.", facts, (section,)), path)
    text = path.read_text(encoding="utf-8")
    for line in ("# Title", "**Verdict.**", "- Mass: **1.2 kg** (less)", "## First part", "| b | - | z |"):
        assert line in text.splitlines()
    assert "| a | 1.235 | x \\| y |" in text
    (name,) = re.findall(r"!\[a straight line\]\((.*?)\)", text)
    assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")


def test_lengths_are_told_beside_what_was_asked() -> None:
    measured = {"least_draft_deg": None, "least_member_mm": 7.96, "least_gap_mm": None}
    assert length_lines(WallMeasures(**measured)) == []
    assert length_lines(WallMeasures(**measured, asked_member_mm=8.0, asked_gap_mm=9.5)) == [
        "thinnest member 8.0 mm, 8 mm asked",
        "narrowest gap none, 9.5 mm asked",
    ]
    assert length_lines(WallMeasures(**measured, asked_member_mm=12.0)) == [
        "thinnest member 8.0 mm, 12 mm asked: NOT KEPT"
    ]
    assert length_lines(run_metrics(surface={"refusal": "the density is too grey"}).walls) == []
