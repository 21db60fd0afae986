"""The loop: remove a little, extract, re-model, judge; the re-modelled solid bounds the next step."""

from cranktopo.iterate.loop import Outcome, Settings, continue_loop, start_loop
from cranktopo.iterate.step import Step, Verdict

__all__ = ["Outcome", "Settings", "Step", "Verdict", "continue_loop", "start_loop"]
