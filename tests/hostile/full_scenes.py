"""Scenes with all features, varied within their kind: most of them valid, whatever the seed."""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any

from tests.featured_throws import featured_crank
from tests.hostile.commands import DESIGN, Case
from tests.hostile.featured_engines import featured_engine
from tests.hostile.scenes import dumped
from tests.keys.packed import packed_in_line, packed_pocketed, packed_v
from tests.random_cranks import random_crank
from tests.random_rods import random_rod_engine

Data = dict[str, Any]
KINDS: tuple[tuple[int, Callable[[int], Data]], ...] = (
    (1, lambda _: packed_in_line()),
    (3, lambda _: packed_v()),
    (2, lambda _: packed_pocketed()),
    (4, featured_engine),
    (2, random_rod_engine),
    (2, lambda seed: _plain(random_crank(seed))),
    (1, lambda seed: _plain(featured_crank(seed))),
)
QUICK = {
    "plan": 4, "loads": 2, "balance": 6, "rod": 4, "bolts": 4, "balancer": 4, "film": 1, "designs copy": 6,
}  # fmt: skip
"""Commands without elements, and how often each is drawn; the processor works for 0.02 to 1 s."""
_NEEDED = {"rod": "rod", "bolts": "bolted_joint", "balancer": "balancer", "film": "bearings"}
"""Table without which a command has nothing to say."""


def full_case(seed: int) -> Case:
    """A quick command on the scene of a seed, as text or as JSON."""
    r = random.Random(f"full {seed}")
    data = full_scene(r, seed)
    commands = [name for name in QUICK if _NEEDED.get(name, "throw") in data]
    command = r.choices(commands, [QUICK[name] for name in commands])[0]
    if command == "designs copy":
        return Case([*command.split(), DESIGN, "y.toml"], {DESIGN: dumped(data).encode()})
    flags = ["--json"] if r.random() < 0.5 else []
    return Case([command, DESIGN, *flags], {DESIGN: dumped(data).encode()})


def full_scene(r: random.Random, seed: int) -> Data:
    """A scene of one of the kinds as plain data, its numbers a little or a lot others."""
    data = r.choices([make for _, make in KINDS], [weight for weight, _ in KINDS])[0](seed)
    spread = r.choice([0.0, 0.02, 0.1, 0.3])
    return _varied(r, data, spread, r.choice([0.2, 0.5, 1.0]))


def _plain(scene: Any) -> Data:
    data: Data = scene.model_dump(mode="json", exclude_none=True, by_alias=True)
    return data


def _varied(r: random.Random, value: Any, spread: float, share: float) -> Any:
    """Plain data with a share of its decimal numbers changed by up to the spread."""
    if isinstance(value, dict):
        return {key: _varied(r, item, spread, share) for key, item in value.items()}
    if isinstance(value, list):
        return [_varied(r, item, spread, share) for item in value]
    return value * r.uniform(1 - spread, 1 + spread) if type(value) is float and r.random() < share else value
