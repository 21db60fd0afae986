"""The verdict on a run: mass, stiffness per mass, fatigue, whether it can be made."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.report.pages.page import Fact, Status
from cranktopo.report.run_record import RunRecord
from cranktopo.report.tables.undercuts import obstacles

_NOTICEABLE_PERCENT = 0.05
_ADJECTIVES = {"torsion": "Torsional"}
_NO_FILLETS = (
    "a density result has no fillets: 'cranktopo remodel {run}' gives it some, then "
    "'cranktopo fatigue' with the re-modelled design and '--out' this run"
)


def headline(metrics: Mapping[str, Any]) -> str:
    """The verdict in one sentence, against the original web in the same model."""
    original = metrics["original_web"]
    mass = _percent(metrics["mass_kg"]["throw"], original["mass_kg"]["throw"])
    parts = [f"{abs(mass):.1f} % {'lighter' if mass < 0 else 'heavier'}"]
    for name, gain in original["gain_of_stiffness_per_mass_percent"].items():
        parts.append(f"{abs(gain):.1f} % {'stiffer' if gain > 0 else 'softer'} in {name} per kilogram")
    text = f"{', '.join(parts[:-1])} and {parts[-1]}" if len(parts) > 1 else parts[0]
    return f"The optimised throw is {text} than the original."


def facts(record: RunRecord) -> tuple[Fact, ...]:
    """The answers of the verdict, mass first."""
    metrics = record.metrics
    return (
        _mass(metrics),
        *_stiffness(metrics),
        fatigue_fact(record.fatigue, _NO_FILLETS.format(run=record.folder)),
        release_fact(metrics),
        _end(metrics),
    )


def fatigue_fact(fatigue: Mapping[str, Any] | None, otherwise: str) -> Fact:
    """Safety against fatigue.

    Args:
        fatigue: the object that `cranktopo fatigue --json` prints for the design, and for its `baseline`
            where one was given; None where it was not assessed.
        otherwise: why it was not assessed.
    """
    entries = (fatigue or {}).get("fatigue", [])
    baseline = (fatigue or {}).get("baseline")
    assessed = next((entry for entry in entries if entry["target"] != baseline), None)
    if assessed is None or assessed.get("safety") is None:
        return Fact("Fatigue", "not assessed", otherwise, "unknown")
    original = next((entry["safety"] for entry in entries if entry["target"] == baseline), None)
    note = f"least safety of {assessed['target']}"
    note += "" if original is None else f"; {baseline} has {original:.2f}"
    return Fact("Fatigue", f"{assessed['safety']:.2f}", note, "good" if assessed["safety"] >= 1 else "bad")


def release_fact(metrics: Mapping[str, Any]) -> Fact:
    """Whether a die or a cutter can make it; `metrics` as metrics.json holds it."""
    surface = metrics["surface"]
    label = "Released by a die"
    if "refusal" in surface:
        return Fact(label, "no", "the density has no surface", "bad")
    undercuts = surface.get("undercuts")
    found = obstacles(surface["cavities"], undercuts)
    if found:
        return Fact(label, "no", "; ".join(found), "bad")
    if undercuts is None:  # a run of an earlier version
        return Fact(label, "not checked", "the topology was free; undercuts are possible", "unknown")
    return Fact(label, "yes", "a die that parts in x = 0 releases it", "good")


def _mass(metrics: Mapping[str, Any]) -> Fact:
    now, before = (m["mass_kg"]["throw"] for m in (metrics, metrics["original_web"]))
    change = _percent(now, before)
    note = f"{change:+.1f} % against the original's {before:.3f} kg"
    return Fact("Mass of the throw", f"{now:.3f} kg", note, _status(-change))


def _stiffness(metrics: Mapping[str, Any]) -> list[Fact]:
    found = []
    gains = metrics["original_web"]["gain_of_stiffness_per_mass_percent"]
    for key, value in metrics["stiffness_per_mass"].items():
        name = next(name for name in gains if key.startswith(name))
        unit = "kN m/rad per kg" if key.endswith("rad_kg") else "kN/mm per kg"
        before = metrics["original_web"]["stiffness_per_mass"][key]
        note = f"{gains[name]:+.1f} % against the original's {before / 1000:.1f}"
        label = f"{_ADJECTIVES.get(name, name.capitalize())} stiffness per mass"
        found.append(Fact(label, f"{value / 1000:.1f} {unit}", note, _status(gains[name])))
    return found


def _end(metrics: Mapping[str, Any]) -> Fact:
    done = metrics["status"] == "converged"
    value = f"{metrics['status']} after {metrics['iterations']} iterations"
    if not metrics["connected"]:
        return Fact("Optimisation", value, "journal and crankpin are not connected", "bad")
    return Fact("Optimisation", value, metrics["stop_reason"], "good" if done else "bad")


def _status(gain_percent: float) -> Status:
    if abs(gain_percent) < _NOTICEABLE_PERCENT:
        return "neutral"
    return "good" if gain_percent > 0 else "bad"


def _percent(now: float, before: float) -> float:
    return 100 * (now / before - 1)
