"""Hostile designs: a valid one with a few of its keys, tables, bytes or numbers changed."""

from __future__ import annotations

import copy
import random
import tomllib
from collections.abc import Callable, Iterator
from typing import Any

from cranktopo.design.loading import builtin_designs, designs_folder
from tests.keys.packed import drawn

Table = dict[str, Any]
VALID = {name: (designs_folder() / f"{name}.toml").read_text(encoding="utf-8") for name in builtin_designs()}


class Raw(str):
    """TOML as it is written, valid or not."""


NUMBERS = (
    "nan", "inf", "-inf", "0", "0.0", "-0.0", "-1", "1e-300", "5e-324", "1e300", "1e308", "1e400", "1e9",
    "1e-6", "1e-12", "0.999999", "1.0000001", "3", "17", "9" * 5000, "0x" + "f" * 5000, "1_000", "+5", "0o17",
)  # fmt: skip
VALUES = (
    *NUMBERS, "true", "false", '"12"', '""', '"nan"', "[]", "[1]", "[[1, 2], [3]]", "{}", "{a = 1}",
    "1979-05-27", "07:32:00", '"a\\u0000b"', '"é µ"', '"../../etc/passwd"', '"/dev/zero"', '"$(x) `y`"',
    '"a\\nb"', "[" * 40 + "]" * 40, "[" * 3000 + "]" * 3000, f'"{"x" * 5000}"', "'''\n'''", "[true]",
    '["a"]', "[nan, nan, nan]", "[3, 2, 1]", "auto", "", '"', "= 1", '"obround"', '"free"', '"spring"',
)  # fmt: skip
WEBS: tuple[Callable[[random.Random], Table], ...] = (
    lambda r: {"outline": "obround", "width_mm": r.uniform(10, 120)},
    lambda r: {
        "outline": "rectangle",
        "width_mm": r.uniform(10, 120),
        "overhang_mm": r.uniform(1, 60),
        "corner_radius_mm": r.choice([0.0, r.uniform(0, 40)]),
    },
    lambda r: {
        "outline": "ellipse",
        "semi_axis_throw_mm": r.uniform(10, 120),
        "semi_axis_lateral_mm": r.uniform(10, 90),
    },
    lambda r: {"outline": "tapered", "main_radius_mm": r.uniform(5, 90), "pin_radius_mm": r.uniform(5, 90)},
    lambda r: _profile(r, r.randint(1, 9)),
)
POCKETS: tuple[Callable[[random.Random], Table], ...] = (
    lambda r: {
        "shape": "cylinder",
        "face": r.choice(["through", "journal", "pin"]),
        "x_mm": r.uniform(-20, 20),
        "y_mm": r.uniform(-30, 80),
        "diameter_mm": r.uniform(0.1, 40),
        **({"depth_mm": r.uniform(0.1, 30)} if r.random() < 0.6 else {}),
    },
    lambda r: {
        "shape": "side",
        "y_mm": r.uniform(-20, 70),
        "length_mm": r.uniform(1, 150),
        "height_mm": r.uniform(0.1, 20),
        "depth_mm": r.uniform(0.1, 60),
        "offset_mm": r.uniform(-5, 5),
        "draft_deg": r.choice([0, 3, 60]),
    },
    lambda r: {
        "shape": "box",
        "face": r.choice(["journal", "pin"]),
        "y_mm": r.uniform(-30, 80),
        "size_x_mm": r.uniform(0.1, 60),
        "size_y_mm": r.uniform(0.1, 60),
        "depth_mm": r.uniform(0.1, 25),
    },
)
ENVELOPES: tuple[Callable[[random.Random], Table], ...] = (
    lambda r: {
        "shape": "box",
        "half_width_mm": r.uniform(1, 200) * r.choice([1, 1, 25.4]),
        "y_min_mm": r.uniform(-200, 50),
        "y_max_mm": r.uniform(-50, 300),
    },
    lambda r: {"shape": "cylinder", "radius_mm": r.uniform(1, 200) * r.choice([1, 1, 25.4, 1000])},
    lambda r: {
        "shape": "outline",
        "points_mm": [[r.uniform(-90, 90), r.uniform(-60, 120)] for _ in range(r.randint(0, 12))],
    },
    lambda r: {"shape": "stl", "file": r.choice(["x.stl", "/dev/zero", ".", "a\0b", "x" * 300, "p.csv"])},
)


def hostile_text(r: random.Random) -> bytes:
    """A design, changed in one to three places; sometimes none of them breaks it.

    Most have many tables: packed scenes, random cranks, engines and rods.
    """
    data = tomllib.loads(r.choice(list(VALID.values()))) if r.random() < 0.3 else drawn(r.randrange(600))
    for _ in range(r.choice([1, 1, 1, 2, 3])):
        data = r.choice(CHANGES)(r, data)
    content = dumped(data).encode("utf-8", "surrogatepass")
    return r.choice(BYTES)(r, content) if r.random() < 0.12 else content


def dumped(data: Table) -> str:
    """TOML of a scene: one line per key, dotted."""
    return "".join(f"{key} = {_value(value)}\n" for key, value in _leaves(data))


def _leaves(data: Table, path: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in data.items():
        if isinstance(value, dict) and value:
            yield from _leaves(value, f"{path}{key}.")
        else:
            yield f"{path}{key}", value


def _value(value: Any) -> str:
    if isinstance(value, Raw):
        return value
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k} = {_value(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, str):
        escaped = "".join(c if c.isprintable() and c not in '"\\' else f"\\u{ord(c):04x}" for c in value)
        return f'"{escaped}"'
    return repr(value)


def _places(data: Any) -> list[tuple[Any, Any]]:
    """Every container with every key or index in it."""
    items = list(data.items()) if isinstance(data, dict) else list(enumerate(data))
    found = [(data, key) for key, _ in items]
    return found + [place for _, value in items if isinstance(value, dict | list) for place in _places(value)]


def _replaced(r: random.Random, data: Table) -> Table:
    container, key = r.choice(_places(data))
    container[key] = Raw(r.choice(VALUES))
    return data


def _number_replaced(r: random.Random, data: Table) -> Table:
    numbers = [(c, k) for c, k in _places(data) if isinstance(c[k], int | float)]
    container, key = r.choice(numbers)
    container[key] = Raw(r.choice(NUMBERS))
    return data


def _scaled(r: random.Random, data: Table) -> Table:
    """Some numbers by a factor: a unit, a slip, or all dimensions of another engine."""
    numbers = [(c, k) for c, k in _places(data) if type(c[k]) is float]
    factor = r.choice([25.4, 1 / 25.4, 1000.0, 1e-3, -1.0, 10.0, 0.1, r.uniform(0.3, 3)])
    chosen = numbers if r.random() < 0.2 else r.sample(numbers, min(len(numbers), r.randint(1, 6)))
    for container, key in chosen:
        container[key] = container[key] * factor
    return data


def _jittered(r: random.Random, data: Table) -> Table:
    """All dimensions a little: scenes near the limits of what fits."""
    for container, key in _places(data):
        if type(container[key]) is float and str(key).endswith("_mm"):
            container[key] *= r.uniform(0.6, 1.6)
    return data


def _removed(r: random.Random, data: Table) -> Table:
    container, key = r.choice(_places(data))
    del container[key]
    return data


def _renamed(r: random.Random, data: Table) -> Table:
    container, key = r.choice([place for place in _places(data) if isinstance(place[0], dict)])
    text = str(key)
    at = r.randrange(len(text))
    new = r.choice(
        [text[:at] + text[at + 1 :], text.upper(), text + "_mm", "diameter_mm", '"é"', '""', "x.y"]
    )
    container[new or "_"] = container.pop(key)
    return data


def _moved(r: random.Random, data: Table) -> Table:
    places = [place for place in _places(data) if isinstance(place[0], dict)]
    (container, key), (target, other) = r.choice(places), r.choice(places)
    value = copy.deepcopy(container[key])
    target[f"{other}" if r.random() < 0.5 else f"{key}"] = value
    return data


def _web(r: random.Random, data: Table) -> Table:
    web = {"thickness_mm": r.uniform(1, 60), **r.choice(WEBS)(r)}
    if r.random() < 0.5:
        web["pocket"] = [r.choice(POCKETS)(r) for _ in range(r.randint(1, 3))]
    if r.random() < 0.3:
        web["bevel"] = [
            {
                "face": r.choice(["journal", "pin"]),
                "y_mm": r.uniform(-60, 120),
                "depth_mm": r.uniform(0.1, 30),
            }
            for _ in range(r.randint(1, 3))
        ]
    return {**data, "web": web}


def _envelope(r: random.Random, data: Table) -> Table:
    return {**data, "envelope": r.choice(ENVELOPES)(r)}


def _settings(r: random.Random, data: Table) -> Table:
    """Settings that belong to no dimension: effects, supports, process, engine."""
    engine = dict(data["engine"]) if isinstance(data.get("engine"), dict) else {}
    whole = dict(engine)
    engine["cylinders"] = r.choice([1, 2, 3, 48, 49])
    engine["firing_order"] = [r.randint(0, 5) for _ in range(r.randint(0, 6))]
    engine["gas"] = r.choice([{"indicator_csv": "p.csv"}, {}, engine.get("gas", {})])
    masses = {"rod_kg": r.uniform(0, 9), "rod_centre_from_big_end_mm": r.uniform(0.1, 300)}
    return r.choice(
        [
            {**data, "engine": engine},
            {**data, "engine": {**whole, "masses": masses}},
            {**data, "effects": {key: r.choice(["on", "off", "auto"]) for key in EFFECTS}},
            {**data, "supports": {"torsion": "spring", "bearing_clearance_mm": 10 ** r.uniform(-6, 3)}},
            {
                **data,
                "supports": {"bending": "spring", "roller_bearing": {"name": r.choice(["HK4520", "x"])}},
            },
            {
                **data,
                "optimise": {"process": r.choice(["forged", "cast", "free"]), "weights": {"bending": 0}},
            },
            {
                **data,
                "material": {"name": r.choice(["31CrMoV9", "x", "custom"]), "poisson": r.uniform(-1, 1)},
            },
        ]
    )


def _goal(r: random.Random, data: Table) -> Table:
    """A goal with limits: signs, numbers, units and quantities that belong together or do not."""
    goal: Table = {r.choice(["minimise", "maximise", "maximise"]): r.choice([*QUANTITIES, *HOSTILE_LIMITS])}
    if r.random() < 0.1:
        goal["minimise"] = "mass"
    limits = {name: _limit(r) for name in r.sample(QUANTITIES, r.randint(0, 4))}
    return {**data, "goal": {**goal, "limits": limits}}


def _limit(r: random.Random) -> Any:
    if r.random() < 0.2:
        return r.choice([*HOSTILE_LIMITS, 3, True, [], [">= 90 %", "<= 110 %"], ["<= 1 %"] * 3, [[">= 1 %"]]])
    sign = r.choice(["<=", ">=", ">=", "<", "=", "≥", ""])
    number = r.choice(["100", "1.5", "1e3", "-5", "0", "nan", "inf", "1,5", "1_0", "٣", "9" * 400, "1e400"])
    return f"{sign} {number if r.random() < 0.4 else 100} {r.choice(UNITS)}"


QUANTITIES = (
    "mass", "inertia", "unbalance", "torsion", "bending", "torsion_per_mass", "bending_per_mass",
    "pin_displacement", "twist", "fatigue_safety",
)  # fmt: skip
UNITS = (
    "%",
    "%",
    "%",
    "",
    "kg",
    "kg mm",
    "kg·mm²",
    "N m/rad",
    "kN/mm",
    "N/mm/kg",
    "mm",
    "deg",
    "°",
    "x" * 99,
)
HOSTILE_LIMITS = ("none", "", " ", "\n", "x" * 5000, "é", "{why}", "%s", "\udcff", "<=", ">= 1 % %", "a\0b")
EFFECTS = ("bending", "torsion", "tangential", "centrifugal", "bearing_compliance", "lateral_symmetry")
CHANGES = (
    _replaced, _replaced, _number_replaced, _scaled, _jittered, _removed, _renamed, _moved, _web, _envelope,
    _settings, _goal,
)  # fmt: skip


def _profile(r: random.Random, count: int) -> Table:
    stations = sorted(r.uniform(-60, 120) for _ in range(count))
    if r.random() < 0.1:
        r.shuffle(stations)
    widths = [r.choice([0.0, r.uniform(0, 60)]) for _ in range(count + r.choice([0, 0, 0, 1]))]
    return {"outline": "profile", "stations_mm": stations, "half_widths_mm": widths}


def _flipped(r: random.Random, content: bytes) -> bytes:
    changed = bytearray(content)
    for _ in range(r.randint(1, 8)):
        changed[r.randrange(len(changed))] = r.randrange(256)
    return bytes(changed)


def _shuffled(r: random.Random, content: bytes) -> bytes:
    lines = content.splitlines(keepends=True)
    r.shuffle(lines)
    return b"".join(lines)


BYTES: tuple[Callable[[random.Random, bytes], bytes], ...] = (
    _flipped,
    _flipped,
    _shuffled,
    lambda r, content: content[: r.randrange(len(content) + 1)],
    lambda r, content: b"\xef\xbb\xbf" + content,
    lambda r, content: content.replace(b"\n", b"\r\n"),
    lambda r, content: content.decode("utf-8", "replace").encode("utf-16"),
    lambda r, content: content + "# é".encode("latin-1"),
    lambda r, content: content[:50] + b"\0" + content[50:],
    lambda r, content: content + content,
    lambda r, content: b"#" * 1_000_000 + b"\n" + content,
    lambda r, content: b"",
    lambda r, content: r.randbytes(400),
)
