"""The loop: remove a little, extract, re-model, evaluate; the re-modelled solid bounds the next step."""

from cranktopo.pipeline.iterate.loop import (
    Outcome,
    continue_loop,
    loop_scene,
    start_loop,
)
from cranktopo.pipeline.iterate.settings import Settings, loop_settings
from cranktopo.pipeline.iterate.step import LoopStep, Verdict

__all__ = [
    "LoopStep",
    "Outcome",
    "Settings",
    "Verdict",
    "continue_loop",
    "loop_scene",
    "loop_settings",
    "start_loop",
]
