"""What a CAD program finds in a STEP file: one named solid in mm, nothing else, by whom and when."""

from __future__ import annotations

import re
from collections import Counter
from contextlib import nullcontext
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.base.formats import PARTS, SolidPart
from cranktopo.base.reproducible import time_of_writing
from cranktopo.bodies.solid.files import export_solid, read_back
from cranktopo.bodies.solid.step import StepLabel, labelled, step_string
from cranktopo.design.loading import builtin_designs, load_scene
from cranktopo.design.named import with_values
from cranktopo.design.schema import Scene
from cranktopo.throw.raw_part.table import Forging
from tests.unit.refit.remodel_cases import WHOLE, known_scene

DAY = "1970-01-02T00:00:00+00:00"
LABEL = StepLabel("my engine half throw", "mm", "cranktopo", "1.2", datetime(2026, 1, 2, tzinfo=UTC))


def entities(text: str) -> dict[str, str]:
    """Each entity of a STEP file, by its number: its text without strings."""
    data = re.sub(r"'(?:[^']|'')*'", "''", text[text.index("DATA;") :])
    return dict(re.findall(r"(#\d+)\s*=\s*([^;]*);", data))


def unused_points(text: str) -> list[str]:
    """Vertices and points that no edge, surface or placement refers to."""
    found = entities(text)
    used = {number for body in found.values() for number in re.findall(r"#\d+", body)}
    return [n for n, body in found.items() if re.match("(VERTEX|CARTESIAN)_POINT", body) and n not in used]


def kinds(text: str) -> Counter[str]:
    return Counter(re.match(r"\w*", body)[0] for body in entities(text).values())  # type: ignore[index]


def surfaces(text: str, kind: str) -> list[tuple[float, ...]]:
    """The numbers of each surface of a kind, in ascending order; complex entities included."""
    number = r"-?\d+\.\d*(?:E[+-]?\d+)?"
    bodies = [body for body in entities(text).values() if re.search(rf"\b{kind}\(", body)]
    return sorted(tuple(float(n) for n in re.findall(number, body)) for body in bodies)


def with_forging(scene: Scene) -> Scene:
    return scene.model_copy(update={"forging": Forging(allowance_mm=2.0, flash_mm=2.0)})


@pytest.fixture
def first_day(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")


def check(text: str, product: str) -> None:
    """One solid of that name in mm, every vertex the end of an edge, no wires or sets of points beside it."""
    counts = kinds(text)
    assert [counts[kind] for kind in ("MANIFOLD_SOLID_BREP", "CLOSED_SHELL", "PRODUCT")] == [1, 1, 1]
    assert [kind for kind in counts if "WIREFRAME" in kind or "GEOMETRIC_SET" in kind] == []
    edges = "".join(body for body in entities(text).values() if body.startswith("EDGE_CURVE"))
    vertices = {n for n, body in entities(text).items() if body.startswith("VERTEX_POINT")}
    assert vertices <= set(re.findall(r"#\d+", edges))
    assert unused_points(text) == []
    lengths = [body for body in entities(text).values() if "LENGTH_UNIT()" in body]
    assert len(lengths) == 1
    assert "SI_UNIT(.MILLI.,.METRE.)" in lengths[0]
    assert re.findall(r"=\s*PRODUCT\('([^']*)',\s*'([^']*)'", text) == [(product, product)]
    assert re.findall(r"=\s*MANIFOLD_SOLID_BREP\('([^']*)'", text) == [product]


@pytest.mark.usefixtures("first_day")
@pytest.mark.parametrize(
    "part",
    [
        pytest.param(part, marks=[pytest.mark.slow] if part in ("raw", "raw_crankshaft") else [])
        for part in PARTS
        if part != "plugs"
    ],
)
def test_one_named_solid(part: SolidPart, mikron: Scene, tmp_path: Path) -> None:
    own = {"rod": "mikron-iiic-rod", "balancer": "balancer-shaft"}.get(part)
    scene = load_scene(own) if own else with_forging(mikron)
    export_solid(scene, part, tmp_path / "one.step")
    text = (tmp_path / "one.step").read_text(encoding="ascii")
    names = {"half": "half throw", "raw": "raw part", "balancer": "balancer shaft"}
    check(text, f"{scene.name} {names.get(part, part.replace('_', ' '))}")
    header = text[: text.index("DATA;")]
    assert header.index("FILE_DESCRIPTION") < header.index("FILE_NAME") < header.index("FILE_SCHEMA")
    assert DAY in header
    assert re.search(r"\('cranktopo [^']+'\),\('cranktopo'\)", header)
    assert "AUTOMOTIVE_DESIGN" in header


DISTINCT = "mikron-iiic", "opposed-piston", "car-diesel"
"""Designs of different webs; one with rounded outlets is slow."""


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.slow] * (name not in DISTINCT)) for name in builtin_designs()],
)
def test_fillets_are_tori(name: str, tmp_path: Path) -> None:
    """One about each journal, with its radii; a spline is what a ball rolled around an outlet leaves."""
    scene = load_scene(name)
    export_solid(scene, "half", tmp_path / "half.step")
    text = (tmp_path / "half.step").read_text(encoding="ascii")
    journals = scene.throw.main_journal, scene.throw.crankpin
    tori = sorted((one.radius_mm + one.fillet_mm, one.fillet_mm) for one in journals)
    assert np.array(surfaces(text, "TOROIDAL_SURFACE")) == pytest.approx(np.array(tori))
    assert surfaces(text, "SURFACE_OF_REVOLUTION") == []
    rounded = any(one.outlet_radius_mm for one in scene.throw.drilling)
    assert bool(surfaces(text, "B_SPLINE_SURFACE")) == rounded


def test_elliptical_fillets_are_revolved_ellipses(mikron: Scene, tmp_path: Path) -> None:
    scene = with_values(mikron, {"throw.crankpin.fillet_axial_mm": 4.0})
    export_solid(scene, "half", tmp_path / "half.step")
    text = (tmp_path / "half.step").read_text(encoding="ascii")
    counts = [len(surfaces(text, f"{kind}_SURFACE")) for kind in ("TOROIDAL", "B_SPLINE")]
    assert counts == [1, 0]
    assert len(surfaces(text, "SURFACE_OF_REVOLUTION")) == 1


@pytest.mark.usefixtures("first_day")
def test_construction_points_of_curves_stay_out(mikron: Scene, tmp_path: Path) -> None:
    """A spline outline with bevels and pockets, whose construction needs points far outside the body."""
    scene = known_scene(mikron, WHOLE)
    export_solid(scene, "web", tmp_path / "web.step")
    check((tmp_path / "web.step").read_text(encoding="ascii"), f"{scene.name} web")


@pytest.mark.usefixtures("first_day")
def test_repeated_exports_are_the_same_bytes(mikron: Scene, tmp_path: Path) -> None:
    for name in ("a.step", "b.step"):
        export_solid(mikron, "half", tmp_path / name)
    assert (tmp_path / "a.step").read_bytes() == (tmp_path / "b.step").read_bytes()


def test_work_that_is_resumed_writes_the_same_bytes(mikron: Scene, tmp_path: Path) -> None:
    """With the date when it was started, whatever the zone that the manifest gives it in."""
    for name, offset in (("first.step", 0), ("second.step", 2)):
        started = datetime(2020, 5, 17, 10 + offset, 30, tzinfo=timezone(timedelta(hours=offset)))
        export_solid(mikron, "web", tmp_path / name, started=started)
    first, second = ((tmp_path / name).read_bytes() for name in ("first.step", "second.step"))
    assert b"'2020-05-17T10:30:00+00:00'" in first
    assert first == second


def test_time_is_now_unless_given(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    assert abs((datetime.now(UTC) - time_of_writing()).total_seconds()) < 5
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    assert time_of_writing().isoformat() == DAY
    for wrong in ("yesterday", "1e3", "9" * 30):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", wrong)
        with pytest.raises(CranktopoError, match="SOURCE_DATE_EPOCH"):
            time_of_writing()


def test_several_solids_are_refused(mikron: Scene, tmp_path: Path) -> None:
    export_solid(mikron, "web", tmp_path / "web.step")
    text = (tmp_path / "web.step").read_text(encoding="ascii")
    check(labelled(text, LABEL), "my engine half throw")
    solid = re.search(r"#\d+ = MANIFOLD_SOLID_BREP[^;]*;\n", text)
    assert solid
    with pytest.raises(CranktopoError, match="1 products with 2 solids"):
        labelled(text.replace(solid[0], solid[0] + solid[0].replace("#", "#9", 1)), LABEL)


@pytest.mark.parametrize(
    ("text", "coded"),
    [
        ("plain", "'plain'"),
        ("Peter's \\ web", "'Peter''s \\\\ web'"),
        ("Kröpfung 曲", "'Kr\\X2\\00F6\\X0\\pfung \\X2\\66F2\\X0\\'"),
        ("two\nlines", "'two\\X2\\000A\\X0\\lines'"),
    ],
)
def test_strings_of_the_standard(text: str, coded: str) -> None:
    assert step_string(text) == coded


@pytest.mark.parametrize(("share", "sound"), [(3e-5, True), (-3e-5, True), (5e-5, False)])
def test_what_is_read_back_may_be_off_by_both_integrations(
    share: float, sound: bool, mikron: Scene, tmp_path: Path
) -> None:
    """Each within 2e-5 of the closed form, on either side of it: seed 56 of the study of a second kernel."""
    path = tmp_path / "web.step"
    volume = export_solid(mikron, "web", path)
    with nullcontext() if sound else pytest.raises(CranktopoError, match="reads back as 1 solids"):
        read_back(path, [volume * (1 + share)])
