"""A shaft on its bearings that takes no time: safety and loads of its webs as they are told."""

from __future__ import annotations

import numpy as np

from cranktopo.engine.histories import LoadHistory
from cranktopo.tasks.shape.each_web.loaded_shaft import LoadedShaft, ShaftFigures, WebInShaft


def told_shaft(safeties: tuple[float, ...], kg: float = 6.0) -> LoadedShaft:
    """A shaft whose loads tell which web has them, by radial force, and its safety, by torque."""
    webs = tuple(
        WebInShaft(
            web=n,
            throw=(n + 1) // 2,
            radial_range_N=1000.0 * n,
            tangential_range_N=1.0,
            torque_range_Nm=1.0,
            safety=safety,
            part="pin_fillet",
        )
        for n, safety in enumerate(safeties, start=1)
    )
    histories = tuple(
        (LoadHistory(np.array([web.web]), np.zeros(1), np.array([web.safety]), np.ones(1), ("state",)),)
        for web in webs
    )
    figures = ShaftFigures(mass_kg=kg, torsion_end_to_end_Nm_per_rad=1e4, safety=min(safeties), webs=webs)
    return LoadedShaft(figures, histories)
