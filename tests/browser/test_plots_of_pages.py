"""Plots of pages in a browser, of what makes them crowded: no text over another, over a point or outside."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from cranktopo.design.loading import load_scene
from cranktopo.report.page import Page, Section
from cranktopo.report.plot import Picture, picture, polar_frame
from cranktopo.report.report_file import html
from cranktopo.tasks.optimise.picture import PANELS
from cranktopo.tasks.shaft_safety.plots import CrankSide, safety_pictures, side_picture, web_pictures
from cranktopo.tasks.throw_fea.scatter import LABELS, Point, scatter_pictures
from cranktopo.tasks.web_shape.page import draw_goal, draw_worst_limit
from tests.studies.page_checks import found_in_plots

SPEEDS = (300.0, 562.5, 825.0)


def six_throws() -> Any:
    """Safeties of twelve webs at three speeds, each a little above the one before."""
    parts = dict.fromkeys(("journal_fillet", "outlets", "elsewhere"), 2.4)
    webs = [
        SimpleNamespace(
            web=n, safety=1.5 + n / 40, pin_fillet=1.5 + n / 40, over_speeds=(2.0, 1.5, 1.7), **parts
        )
        for n in range(1, 13)
    ]
    speeds = [SimpleNamespace(speed_rpm=speed, safety=1.5) for speed in SPEEDS]
    return SimpleNamespace(
        webs=webs, speeds=speeds, safety=1.525, worst=SimpleNamespace(web=1, speed_rpm=562.5)
    )


def steep_history() -> list[dict[str, Any]]:
    """A volume fraction that stays at its limit, and a projection that gets steeper."""
    names = ("bending_compliance_N_mm", "torsion_compliance_N_mm", "objective")
    rows = (dict.fromkeys(names, 900 / n**2) for n in range(1, 24))
    return [
        {
            **row,
            "iteration": n,
            "beta": 2 ** (n // 5),
            "volume_fraction": min(0.2 + n / 15, 0.3),
            "greyness": 1 / n,
        }
        for n, row in enumerate(rows, start=1)
    ]


def alike_webs() -> tuple[Picture, ...]:
    """Five webs that lie close to each other, with long names."""
    points = [Point(f"opposed-piston-variant-{n}", 2.6 - n / 50, 355.0 + n) for n in range(5)]
    return scatter_pictures(dict.fromkeys(LABELS.values(), points), 0, {})


def settled_goal() -> Any:
    quantity = SimpleNamespace(name="mass", unit="kg", label="mass")
    rounds = [SimpleNamespace(values={"mass": 1.0 - n * 1e-4}, excess_percent=(n * 1e-3,)) for n in range(3)]
    values = SimpleNamespace(original={"mass": 1.0})
    return SimpleNamespace(
        rounds=rounds, values=values, goal=SimpleNamespace(quantity=quantity), best_round=2
    )


def crowded() -> Page:
    scene, found = load_scene("industrial-gas"), six_throws()
    curves = 40_000 * np.sin(np.arange(12 * 4).reshape(6, 2, 4))
    places = [n * scene.pitch_mm for n in range(7)]
    load = 155_019 * np.exp(1j * np.arange(3))
    pictures = (
        *safety_pictures(found),
        side_picture(found, places, CrankSide.of(scene)),
        *web_pictures(750.0, SimpleNamespace(**dict.fromkeys(SECTIONS, curves), angle_deg=np.arange(4.0))),  # type: ignore[arg-type]
        *(picture(f"panel-{n}", "", panel, steep_history()) for n, panel in enumerate(PANELS)),
        *alike_webs(),
        picture("goal", "", draw_goal, settled_goal()),
        picture("limit", "", draw_worst_limit, settled_goal()),
        picture("polar", "", partial(polar_frame, points=load, largest=155_019.0, circles=4), polar=True),
    )
    return Page("Crowded", "plots", "Many curves.", (), (Section("a", "Plots", "", (), pictures),))


SECTIONS = ("bending_Nm", "side_bending_Nm", "torque_Nm", "shear_N")


def test_texts_of_crowded_plots_are_apart_and_whole(browser: Any, tmp_path: Path) -> None:
    """The names of two axes were cut, those of the steps of the projection lay on a curve."""
    path = tmp_path / "crowded.html"
    path.write_text(html(crowded()), encoding="utf-8")
    context = browser.new_context(viewport={"width": 1280, "height": 800})
    page = context.new_page()
    page.goto(path.as_uri())
    assert page.locator("figure svg").count() > 12
    assert found_in_plots(page) == []
    named = [line for line in found_in_plots(page, curves=True) if '"β' in line and "31, 111, 180" in line]
    assert named == [], "no name of a step lies on a curve"
    context.close()
