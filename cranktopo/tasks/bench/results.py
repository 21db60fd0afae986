"""Results of finished jobs, as numbers of gauges and as designs to be kept."""

from __future__ import annotations

import subprocess
from pathlib import Path

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import read_text_file
from cranktopo.base.line_width import unfolded
from cranktopo.runs.stored import unchanged
from cranktopo.tasks.bench.job_kinds import FOUND, SEARCHES
from cranktopo.tasks.bench.jobs import BenchJob, own_command
from cranktopo.tasks.bench.part_words import PARTS, part_words
from cranktopo.tasks.bench.study_words import STUDIES, loop_of
from cranktopo.tasks.bound.result import BoundResult, ProvenBound
from cranktopo.tasks.evaluate.result import EvaluationList
from cranktopo.tasks.fatigue.criteria import shortfall_words
from cranktopo.tasks.optimise.result import RunMetrics
from cranktopo.tasks.shaft_safety.result import ShaftAssessment
from cranktopo.tasks.throw_fatigue.result import FatigueResult, FieldFatigue, OutletAcceptance
from cranktopo.tasks.throw_fatigue.text import load_words
from cranktopo.tasks.throw_fea.result import EvaluationResult
from cranktopo.tasks.web_shape.result import ShapeResult

_REMODEL_S = 3600


def job_numbers(job: BenchJob) -> dict[str, float]:
    """Return the gauges that a finished job tells, by name.

    A bound is called `bound_` and its quantity, its share of the design `bound_percent_` and its quantity.
    """
    reader = {"shape": _of_shape, "bound": _of_bound, "fatigue": _of_fatigue}
    reader |= {"optimise": _of_optimise, "evaluate": _of_evaluation, "iterate": _of_loop}
    if job.known.kind not in reader:
        return {}
    try:
        return reader[job.known.kind](job)
    except (CranktopoError, ValueError, IndexError):  # it failed, and has no result
        return {}


def job_words(job: BenchJob) -> list[str]:
    """Return what a finished job found, in a few lines."""
    try:
        if job.known.kind == "shape":
            return [*_lines(job)[:1], *_prices(_shape(job))]
        if job.known.kind == "fatigue":
            return _fatigue_words(_fatigue(job))
        if job.known.kind == "bound":
            bound = _bound(job)
            if bound.value is None:
                return ["no web of the design space keeps all limits"]
            return [f"no web of the design space has {bound.quantity} beyond {bound.value:.4g}"]
        if job.known.kind == "shaft":
            return _shaft_words(ShaftAssessment.of_json(job.printed(), _place(job)))
        if job.known.kind == "evaluate":
            return _evaluation_words(_evaluation(job))
        if job.known.kind in STUDIES:
            return STUDIES[job.known.kind].words(job.out)
        if job.known.kind in PARTS:
            return part_words(job.known.kind, job.printed(), _place(job))
        if job.known.kind == "extract":
            return [f"surface written: {(job.place / 'surface.stl').resolve()}"]
    except (CranktopoError, ValueError, IndexError):
        return []
    return _lines(job)[:1]


def job_table(job: BenchJob) -> list[list[str]]:
    """Return the table of a finished study, the heads first; empty for other jobs."""
    if job.known.kind not in STUDIES:
        return []
    try:
        return STUDIES[job.known.kind].table(job.out)
    except (CranktopoError, ValueError, IndexError):
        return []


def _lines(job: BenchJob) -> list[str]:
    return [line for line in unfolded(job.stdout()) if line.strip()]


def _shape(job: BenchJob) -> ShapeResult:
    return ShapeResult.read(unchanged(job.out / "shape.json"))


def _fatigue(job: BenchJob) -> FatigueResult:
    return FatigueResult.of_json(job.printed(), _place(job))


def _bound(job: BenchJob) -> ProvenBound:
    return BoundResult.of_json(job.printed(), _place(job)).bound


def _evaluation(job: BenchJob) -> EvaluationResult:
    return EvaluationList.of_json(job.printed(), _place(job)).evaluations[0]


def _place(job: BenchJob) -> str:
    return f"job {job.known.id}"


def _prices(shape: ShapeResult) -> list[str]:
    """Return what each limit costs, as `shape` prints it."""
    return [
        f"1 % of {price.quantity} {price.sense} costs {price.goal_percent_per_percent:.2f} % "
        f"{shape.goal.quantity.name}"
        for price in shape.prices
        if abs(price.goal_percent_per_percent or 0.0) >= 0.005  # as it is rounded
    ]


def _evaluation_words(evaluation: EvaluationResult) -> list[str]:
    units = {
        "torsion": (evaluation.torsion_Nm_per_rad, "kN m/rad"),
        "bending": (evaluation.bending_N_per_mm, "kN/mm"),
    }
    return [
        f"{name} {value / 1e3:.4g} {unit}, within {evaluation.error_estimate_percent[name]:.2g} %"
        for name, (value, unit) in units.items()
    ]


def _shaft_words(assessment: ShaftAssessment) -> list[str]:
    stiff = assessment.stiffness.end_to_end_Nm_per_rad / 1e3
    lines = [f"whole shaft: {assessment.mass_kg:.4g} kg, {stiff:.4g} kN m/rad from end to end"]
    lines += [f"first natural frequency {hz:.4g} Hz" for hz in assessment.natural_frequencies_Hz[:1]]
    if assessment.on_bearings:
        loads = [bearing for speed in assessment.on_bearings for bearing in speed.main_bearings]
        worst = max(loads, key=lambda bearing: bearing.largest_N)
        lines.append(f"largest main bearing force {worst.largest_N / 1e3:.4g} kN, bearing {worst.bearing}")
    if found := assessment.safety:
        place = found.worst.critical.place
        lines.append(f"least safety {found.safety:.3g}, web {found.worst.web}: {place}")
    return lines


def _fatigue_words(fatigue: FatigueResult) -> list[str]:
    found = fatigue.fatigue[0]
    if isinstance(found, FieldFatigue):
        short = shortfall_words(fatigue.method, found.safety)
        lacks = f"; it {short}" if short else ""
        return [f"least safety {found.safety:.3g} {load_words(fatigue)}: {found.critical.place}{lacks}"]
    ways = {"polynomials": found.fillets.closed_form, "elements": found.fillets.finite_elements}
    lines = [found.not_covered] if found.not_covered else []
    lines += [f"UR M53: {found.verdict}, {found.safety:.3g} of at least {found.least_acceptability:.3g}"]
    for fillet, governs in found.governing_factors.items():
        both = ", ".join(f"{by[fillet].acceptability:.3g} by {way}" for way, by in ways.items())
        lines.append(f"{fillet} fillet: {both}; {f'{governs} govern' if governs else 'not judged'}")
    return lines + [_outlet_words(outlet) for outlet in found.outlets]


def _outlet_words(outlet: OutletAcceptance) -> str:
    found = outlet.acceptability, outlet.elements and outlet.elements.acceptability
    ways = zip(found, ("polynomials", "elements"), strict=True)
    both = ", ".join(f"{safety:.3g} by {way}" for safety, way in ways if safety is not None)
    governs = f"{outlet.governed_by} govern" if outlet.governed_by else "not judged"
    return f"outlet at {outlet.angle_deg:.0f} deg ({outlet.key}): {f'{both}; ' if both else ''}{governs}"


def variant_of(job: BenchJob) -> str | None:
    """Return the design that a finished job ends with; a density is re-modelled first."""
    if job.known.kind == "shape":
        return _design(job.out / "web.toml")
    if job.known.kind in ("fatigue", "evaluate"):
        return _design(job.place / "design.toml")
    if job.known.kind == "remodel":
        return next(_design(file) for file in sorted(job.out.glob("*.toml")))
    if job.known.kind == "iterate":
        best = loop_of(job.out).best
        return _design(job.out / best.folder / "web.toml") if best else None
    if job.known.kind in SEARCHES:
        return _design(job.place / FOUND)
    if job.known.kind != "optimise":
        return None
    if not (job.out / "remodel").is_dir():
        line = own_command("remodel", "out")
        subprocess.run(line, cwd=job.place, capture_output=True, check=False, timeout=_REMODEL_S)
    return next((_design(file) for file in sorted(job.out.glob("remodel/*.toml"))), None)


def _design(file: Path) -> str:
    if not file.is_file():
        raise CranktopoError(f"'{file}': is missing.")
    return read_text_file(unchanged(file), f"'{file}'")


def _of_shape(job: BenchJob) -> dict[str, float]:
    return _evaluated(_shape(job).result)


def _evaluated(entry: EvaluationResult) -> dict[str, float]:
    found = {
        "mass": entry.mass_kg.throw,
        "inertia": entry.inertia_kg_mm2,
        "unbalance": entry.unbalance_kg_mm,
        "torsion": entry.torsion_Nm_per_rad,
        "bending": entry.bending_N_per_mm,
        "torsion_per_mass": entry.stiffness_per_mass.torsion_Nm_per_rad_kg,
        "bending_per_mass": entry.stiffness_per_mass.bending_N_per_mm_kg,
    }
    safety = entry.fatigue_safety
    return found if safety is None else {**found, "fatigue_safety": safety}


def _of_loop(job: BenchJob) -> dict[str, float]:
    best = loop_of(job.out).best
    if best is None:
        return {}
    return {
        "mass": best.throw_kg,
        "torsion": best.torsion_Nm_per_rad,
        "bending": best.bending_N_per_mm,
        "torsion_per_mass": best.torsion_per_kg,
        "bending_per_mass": best.bending_per_kg,
    }


def _of_evaluation(job: BenchJob) -> dict[str, float]:
    return _evaluated(_evaluation(job))


def _of_bound(job: BenchJob) -> dict[str, float]:
    bound = _bound(job)
    named = {"bound": bound.value, "bound_percent": bound.percent_of_original}
    return {f"{name}_{bound.quantity}": value for name, value in named.items() if value is not None}


def _of_fatigue(job: BenchJob) -> dict[str, float]:
    entries = _fatigue(job).fatigue
    if isinstance(found := entries[0], FieldFatigue):
        return {"fatigue_safety": min(entry.safety for entry in entries)}
    return {
        f"m53_{fillet}{ending}": by[fillet].acceptability
        for by, ending in ((found.fillets.closed_form, ""), (found.fillets.finite_elements, "_elements"))
        for fillet in ("pin", "journal")
    }


def _of_optimise(job: BenchJob) -> dict[str, float]:
    return {"mass": RunMetrics.read(unchanged(job.out / "metrics.json")).mass_kg.throw}
