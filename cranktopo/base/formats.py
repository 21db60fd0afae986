"""Forms that the program writes, by file ending or part; loads nothing, so that help can name them."""

from __future__ import annotations

from typing import Literal, get_args

SurfaceFormat = Literal["stl", "3mf", "glb"]
SURFACES: tuple[SurfaceFormat, ...] = get_args(SurfaceFormat)
PLOTS = (".png", ".svg", ".pdf")
DRAWINGS = (*PLOTS, ".dxf")
SOLIDS = (".step", ".stp", ".stl")
SolidPart = Literal[
    "throw", "half", "web", "second_web", "crankshaft", "rod", "balancer", "raw", "raw_crankshaft", "plugs"
]
PARTS: tuple[SolidPart, ...] = get_args(SolidPart)
Exported = SolidPart | Literal["reduced"]
EXPORTS: tuple[Exported, ...] = (*PARTS, "reduced")
"""Parts, and the reduced model of the whole shaft."""
ARRAYS = (".npz",)
