"""Results of finished jobs, as numbers of gauges and as designs to be kept."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import read_json, read_text_file
from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.tasks.bench.jobs import BenchJob, own_command

_REMODEL_S = 3600


def job_numbers(job: BenchJob) -> dict[str, float]:
    """Return the gauges that a finished job tells, by name; a bound is called `bound_` and its quantity."""
    reader = {"shape": _of_shape, "bound": _of_bound, "fatigue": _of_fatigue}
    reader |= {"optimise": _of_optimise, "evaluate": _of_evaluation}
    if job.known.kind not in reader:
        return {}
    try:
        return reader[job.known.kind](job)
    except (KeyError, TypeError, ValueError, IndexError):
        return {}


def job_words(job: BenchJob) -> list[str]:
    """Return what a finished job found, in a few lines."""
    try:
        if job.known.kind == "shape":
            return [*job.stdout().splitlines()[:1], *_prices(read_json(job.out / "shape.json"))]
        if job.known.kind == "fatigue":
            return _fatigue_words(json.loads(job.stdout()))
        if job.known.kind == "bound":
            bound = json.loads(job.stdout())["bound"]
            return [f"no web of the design space has {bound['quantity']} beyond {bound['value']:.4g}"]
        if job.known.kind == "shaft":
            return _shaft_words(json.loads(job.stdout()))
        if job.known.kind == "evaluate":
            return _evaluation_words(json.loads(job.stdout())["evaluations"][0])
        if job.known.kind == "extract":
            return [f"surface written: {(job.place / 'surface.stl').resolve()}"]
    except (CranktopoError, KeyError, TypeError, ValueError, IndexError):
        return []
    return [line for line in job.stdout().splitlines() if line.strip()][:1]


def _prices(told: dict[str, Any]) -> list[str]:
    """Return what each limit costs, as `shape` prints it."""
    goal = told["goal"].get("minimise") or told["goal"]["maximise"]
    return [
        f"1 % of {price['quantity']} {price['sense']} costs {price['goal_percent_per_percent']:.2f} % {goal}"
        for price in told["prices"]
        if abs(price["goal_percent_per_percent"] or 0.0) >= 0.005  # as it is rounded
    ]


def _evaluation_words(told: dict[str, Any]) -> list[str]:
    found = _evaluated(told)
    units = {"torsion": ("kN m/rad", 1e3), "bending": ("kN/mm", 1e3)}
    return [
        f"{name} {found[name] / size:.4g} {unit}, within {told['error_estimate_percent'][name]:.2g} %"
        for name, (unit, size) in units.items()
    ]


def _shaft_words(told: dict[str, Any]) -> list[str]:
    stiff = told["torsion"]["end_to_end_Nm_per_rad"] / 1e3
    lines = [f"whole shaft: {told['mass_kg']:.4g} kg, {stiff:.4g} kN m/rad from end to end"]
    lines += [f"first natural frequency {hz:.4g} Hz" for hz in told["natural_frequencies_Hz"][:1]]
    if told["on_bearings"]:
        loads = [bearing for speed in told["on_bearings"] for bearing in speed["main_bearings"]]
        worst = max(loads, key=lambda bearing: bearing["largest_N"])
        lines.append(
            f"largest main bearing force {worst['largest_N'] / 1e3:.4g} kN, bearing {worst['bearing']}"
        )
    if safety := told.get("safety"):
        place = safety["worst"]["critical"]["place"]
        lines.append(f"least safety {safety['safety']:.3g}, web {safety['worst']['web']}: {place}")
    return lines


def _fatigue_words(told: dict[str, Any]) -> list[str]:
    found = told["fatigue"][0]
    if told["method"] != "m53":
        fails = " is below 1, it fails" if found["safety"] < 1 else ""
        return [f"least safety {found['safety']:.3g}{fails}: {found['critical']['place']}"]
    names = {"polynomials": "closed_form", "elements": "finite_elements"}
    lines = [found["not_covered"]] if found.get("not_covered") else []
    lines += [
        f"UR M53: {found['verdict']}, {found['safety']:.3g} of at least {found['least_acceptability']:.3g}"
    ]
    for fillet, governs in found["governing_factors"].items():
        values = {way: found["fillets"][name][fillet]["acceptability"] for way, name in names.items()}
        both = ", ".join(f"{value:.3g} by {way}" for way, value in values.items())
        lines.append(f"{fillet} fillet: {both}; {f'{governs} govern' if governs else 'not judged'}")
    return lines


def variant_of(job: BenchJob) -> str | None:
    """Return the design that a finished job ends with; a density is re-modelled first."""
    if job.known.kind == "shape":
        return _design(job.out / "web.toml")
    if job.known.kind in ("fatigue", "evaluate"):
        return _design(job.place / "design.toml")
    if job.known.kind == "remodel":
        return next(_design(file) for file in sorted(job.out.glob("*.toml")))
    if job.known.kind != "optimise":
        return None
    if not (job.out / "remodel").is_dir():
        line = own_command("remodel", "out")
        subprocess.run(line, cwd=job.place, capture_output=True, check=False, timeout=_REMODEL_S)
    return next((_design(file) for file in sorted(job.out.glob("remodel/*.toml"))), None)


def _design(file: Path) -> str:
    if not file.is_file():
        raise CranktopoError(f"'{file}': is missing.")
    return read_text_file(file, f"'{file}'")


def _of_shape(job: BenchJob) -> dict[str, float]:
    result = read_json(job.out / "shape.json")["result"]
    return _evaluated(result)


def _evaluated(entry: dict[str, Any]) -> dict[str, float]:
    ratios, supports = entry["stiffness_per_mass"], entry["supports"]
    found = {
        "mass": entry["mass_kg"]["throw"],
        "inertia": entry["inertia_kg_mm2"],
        "unbalance": entry["unbalance_kg_mm"],
        "torsion": entry["torsion"][f"{supports['torsion']}_Nm_per_rad"],
        "bending": entry["bending"][f"{supports['bending']}_N_per_mm"],
        "torsion_per_mass": ratios["torsion_Nm_per_rad_kg"],
        "bending_per_mass": ratios["bending_N_per_mm_kg"],
    }
    safety = entry.get("fatigue_safety")
    return {**found, **({} if safety is None else {"fatigue_safety": safety})}


def _of_evaluation(job: BenchJob) -> dict[str, float]:
    return _evaluated(json.loads(job.stdout())["evaluations"][0])


def _of_bound(job: BenchJob) -> dict[str, float]:
    bound = json.loads(job.stdout())["bound"]
    return {f"bound_{bound['quantity']}": bound["value"]} if bound["quantity"] in QUANTITIES else {}


def _of_fatigue(job: BenchJob) -> dict[str, float]:
    told = json.loads(job.stdout())
    if told["method"] != "m53":
        return {"fatigue_safety": min(entry["safety"] for entry in told["fatigue"])}
    fillets = told["fatigue"][0]["fillets"]
    return {
        f"m53_{fillet}{ending}": fillets[way][fillet]["acceptability"]
        for way, ending in (("closed_form", ""), ("finite_elements", "_elements"))
        for fillet in ("pin", "journal")
    }


def _of_optimise(job: BenchJob) -> dict[str, float]:
    return {"mass": read_json(job.out / "metrics.json")["mass_kg"]["throw"]}
