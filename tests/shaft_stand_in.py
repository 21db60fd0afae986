"""A shaft on its bearings that takes no time: safety and loads of its webs as they are told."""

from __future__ import annotations

import numpy as np

from cranktopo.engine.histories import WebHistory
from cranktopo.tasks.shaft_safety.result import WebSafety
from cranktopo.tasks.web_shape.each_web.loaded_shaft import (
    LoadedShaft,
    ShaftFigures,
    WebInShaft,
    WebsInShaft,
)


def told_shaft(safeties: tuple[float, ...], kg: float = 6.0) -> LoadedShaft:
    """A shaft whose loads tell which web has them, by radial force, and its safety, by torque."""
    webs = tuple(
        WebInShaft(
            web=n,
            throw=(n + 1) // 2,
            bending_range_Nm=100.0 * n,
            side_bending_range_Nm=1.0,
            torque_range_Nm=1.0,
            safety=safety,
            part="pin_fillet",
        )
        for n, safety in enumerate(safeties, start=1)
    )
    none, one = np.zeros(1), np.ones(1)
    histories = tuple(
        (WebHistory(one * web.web, none, one * web.safety, one, ("state",), none, none),) for web in webs
    )
    figures = ShaftFigures(mass_kg=kg, torsion_end_to_end_Nm_per_rad=1e4, safety=min(safeties), webs=webs)
    return LoadedShaft(figures, histories)


def told_webs(safeties: tuple[float, ...]) -> WebsInShaft:
    """The safeties of that shaft alone."""
    webs = tuple(
        WebSafety(
            web=n,
            throw=(n + 1) // 2,
            pin_fillet=safety,
            journal_fillet=9.0,
            outlets=None,
            elsewhere=None,
            safety=safety,
            part="pin_fillet",
            speed_rpm=2100.0,
            over_speeds=(safety,),
        )
        for n, safety in enumerate(safeties, start=1)
    )
    return WebsInShaft(webs=webs)
