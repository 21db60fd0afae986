"""The loop: remove a little, extract, re-model, evaluate; the re-modelled solid bounds the next step.

Its best web is the start of a shape optimisation.
"""

from cranktopo.pipeline.iterate.loop import (
    continue_loop,
    loop_scene,
    start_loop,
)
from cranktopo.pipeline.iterate.outcome import Outcome
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
