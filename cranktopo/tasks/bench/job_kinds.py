"""Kinds of long work that a page may ask for, each with its command, options, and where its result lies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.base.errors import CranktopoError

_GOAL = ("minimise", "maximise", "limit", "web")
KINDS: Mapping[str, tuple[str, ...]] = {
    "optimise": ("volume-fraction", "resolution-mm", "max-iterations", *_GOAL),
    "shape": _GOAL,
    "bound": (*_GOAL, "resolution-mm"),
    "fatigue": ("method",),
    "iterate": ("steps", "web"),
    "accuracy": ("budget",),
    "sweep": ("vary", "stage", "workers"),
    "evaluate": ("accuracy",),
    "shaft": ("bearings", "method"),
    "remodel": ("min-wall-mm", "min-radius-mm", "draft-deg"),
    "extract": (),
    "bolts": (),
    "rod": ("method",),
    "lighter rod": ("method",),
    "balancer": (),
    "lighter balancer": (),
}
"""Jobs, with the options that the page may give them."""
SEARCHES = {"lighter rod": "--lighter", "lighter balancer": "--redesign"}
"""Jobs of a command of another name, with its option that has the design it found written."""
OF_RUN = ("remodel", "extract")
"""Those that take the run of another job in place of the design."""
RESUMABLE = ("optimise", "shape", "sweep", "iterate")
KEPT_EARLY = {"accuracy": "accuracy.json"}
"""Those that keep what is done when they are stopped, with the file in their run that tells it."""
OUT, SURFACE, FOUND = "out", "surface.stl", "found.toml"
_WITH_RUN = ("optimise", "shape", "sweep", "remodel", "iterate", "accuracy")
_OUTPUT = dict.fromkeys(_WITH_RUN, OUT) | {"extract": SURFACE}
"""Results that they write, in their own folder; the others print them."""


def check_kind(kind: str, options: Mapping[str, Any]) -> None:
    """Refuse a job that is none, and options that it has not."""
    if kind not in KINDS:
        raise CranktopoError("job: there is no such command.")
    for name, chosen in options.items():
        if name not in KINDS[kind]:
            raise CranktopoError(f"job: {kind} has no option of that name here.")
        for value in chosen if isinstance(chosen, list) else [chosen]:
            if not isinstance(value, str | int | float) or not str(value).strip():
                raise CranktopoError(f"job: --{name} needs a value.")


def command_words(kind: str, target: str, options: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the words of the command that is a job, in its own folder.

    Args:
        target: the design, or the run of another job.
    """
    found = [kind.removeprefix("lighter "), target]
    found += [f"{SEARCHES[kind]}={FOUND}"] if kind in SEARCHES else []
    for name, chosen in options.items():
        found += [f"--{name}={value}" for value in (chosen if isinstance(chosen, list) else [chosen])]
    return (*found, *(("--out", _OUTPUT[kind]) if kind in _OUTPUT else ("--json",)))
