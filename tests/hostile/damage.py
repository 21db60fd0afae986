"""Damaged files: bytes, JSON and arrays changed in one place, at random by a seed."""

from __future__ import annotations

import io
import json
import random
from collections.abc import Callable
from typing import Any

import numpy as np

from cranktopo.runs.manifest import settings_hash
from tests.hostile.scenes import BYTES

WORDS: tuple[Any, ...] = (
    None, True, 0, -1, 7, 3.5, -1e308, 1e-320, "", "x", "1", "../../x", "/etc/passwd", "\x1b[2J", "x" * 999,
    [], {}, [[]], [None], [1, 2], {"a": 1}, "done", "2026-13-40",
)  # fmt: skip
RAW = ("9" * 400, "1e999", "NaN", "-Infinity", "[" * 2000 + "]" * 2000, '"\\ud800"')
PLACES = ("pipe", "device", "folder", "loop")


def damaged(r: random.Random, name: str, content: bytes) -> bytes | str:
    """The content of a file with one kind of damage, or what stands in its place."""
    kind = r.random()
    if kind < 0.08:
        return r.choice(PLACES)
    if kind < 0.45 or not name.endswith((".json", ".npz")):
        return _bytes(r, content)
    return _json(r, name, content) if name.endswith(".json") else _arrays(r, content)


def _bytes(r: random.Random, content: bytes) -> bytes:
    if r.random() < 0.4:
        return content[: r.randrange(len(content))]
    return r.choice(BYTES)(r, content or b"x")


def _places(data: Any) -> list[tuple[Any, Any]]:
    items = list(data.items()) if isinstance(data, dict) else list(enumerate(data))
    found = [(data, key) for key, _ in items]
    return found + [place for _, value in items if isinstance(value, dict | list) for place in _places(value)]


def _changed(r: random.Random, data: Any) -> Any:
    """Plain data with a value replaced, removed or moved."""
    places = _places(data)
    if not places:
        return data
    container, key = r.choice(places)
    change = r.random()
    if change < 0.2:
        del container[key]
    elif change < 0.3:
        other, place = r.choice(places)
        container[key] = (
            json.loads(json.dumps(other[place])) if place in other or isinstance(other, list) else 0
        )
    elif change < 0.4:
        container[key] = "@raw@"
    else:
        container[key] = r.choice(WORDS)
    return data


def _text(r: random.Random, data: Any) -> str:
    return json.dumps(data).replace('"@raw@"', r.choice(RAW))


def _json(r: random.Random, name: str, content: bytes) -> bytes:
    data = json.loads(content)
    if r.random() < 0.1:
        return _text(r, r.choice(WORDS)).encode()
    for _ in range(r.choice([1, 1, 2, 4])):
        data = _changed(r, data)
    if name == "manifest.json" and r.random() < 0.7 and {"scene", "options"} <= set(data):
        data["settings_sha256"] = settings_hash(data["scene"], data["options"])  # by someone who knows
    return _text(r, data).encode("utf-8", "surrogatepass")


CHANGES: tuple[Callable[[random.Random, np.ndarray], np.ndarray], ...] = (
    lambda r, a: np.full(a.shape, np.nan),
    lambda r, a: np.where(np.arange(a.size).reshape(a.shape) == r.randrange(a.size), np.inf, a),
    lambda r, a: a.ravel(),
    lambda r, a: a[..., None],
    lambda r, a: a[:0],
    lambda r, a: a[:-1],
    lambda r, a: a.astype(str),
    lambda r, a: a.astype(complex),
    lambda r, a: -a - 1e300,
    lambda r, a: np.array(3),
    lambda r, a: a.astype(np.int8),
)


def _arrays(r: random.Random, content: bytes) -> bytes:
    with np.load(io.BytesIO(content)) as file:
        arrays = dict(file)
    name = r.choice([*arrays, *(["__state__"] * len(arrays) if "__state__" in arrays else [])])
    if name in ("__state__", "about") and r.random() < 0.8:
        text = str(arrays[name]) if name == "about" else arrays[name].tobytes().decode()
        text = _text(r, _changed(r, json.loads(text)))
        arrays[name] = np.array(text) if name == "about" else np.frombuffer(text.encode(), np.uint8)
    elif r.random() < 0.25 or arrays[name].dtype.kind not in "fiu":
        del arrays[name]
    else:
        arrays[name] = r.choice(CHANGES)(r, np.atleast_1d(arrays[name].astype(np.float64)))
    out = io.BytesIO()
    np.savez(out, **arrays)
    return out.getvalue()
