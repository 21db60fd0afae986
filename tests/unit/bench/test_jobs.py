"""Jobs are commands in processes of their own: they end, fail and are found again whoever started them."""

from __future__ import annotations

import json
import os
import shutil
import signal
import time
from collections.abc import Sequence
from pathlib import Path

import psutil
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import write_json
from cranktopo.base.line_width import in_width
from cranktopo.base.notes import pace_of
from cranktopo.design.loading import design_text
from cranktopo.tasks.balancer.result import BalancerStrength
from cranktopo.tasks.bench.job_kinds import command_words
from cranktopo.tasks.bench.jobs import BenchJob, Jobs, reap
from cranktopo.tasks.bench.results import job_numbers, job_table, job_words, variant_of
from cranktopo.tasks.bolts.result import BoltChecks
from cranktopo.tasks.evaluate.result import EvaluationList
from cranktopo.tasks.iterate.result import LoopResult, LoopStep, StepRow
from cranktopo.tasks.shaft_safety.result import ShaftAssessment
from cranktopo.tasks.throw_fatigue.result import FatigueResult
from cranktopo.tasks.throw_fea.studies import StudyResult
from cranktopo.tasks.web_shape.result import ShapeResult
from tests.filled import filled

TEXT = design_text("mikron-iiic-plain")
MET = "met: mass -5.0 %, torsion +0.2 %, bending +1.5 % against the original web, in a sentence of two lines"


def ended(jobs: Jobs, id_: str) -> BenchJob:
    for _ in range(6000):
        reap()
        if jobs.job(id_).state != "running":
            return jobs.job(id_)
        time.sleep(0.1)
    raise AssertionError("it does not end")


def test_a_job_that_fails_says_why_and_is_found_by_the_next_server(tmp_path: Path) -> None:
    place = tmp_path / "bench" / "mine" / "jobs"
    job = Jobs(place).start("fatigue", TEXT, {"method": "none"})
    assert job.command == "cranktopo fatigue design.toml --method=none --json"
    line = "cranktopo fatigue bench/mine/jobs/001/design.toml --method=none --json"
    assert Jobs(place).job("001").as_json(tmp_path)["command"] == line, "as it is typed in the folder"
    found = ended(Jobs(place), job.known.id)
    told = found.as_json()
    assert (told["state"], told["resumable"]) == ("failed", False)
    assert "none" in told["notes"][-1]
    assert job_numbers(found) == {}


def test_a_job_is_stopped_and_can_go_on(tmp_path: Path) -> None:
    """As one of a bench in the background, which ignores Ctrl-C as all that a shell starts there."""
    jobs, before = Jobs(tmp_path), signal.signal(signal.SIGINT, signal.SIG_IGN)
    job = jobs.start("optimise", TEXT, {"volume-fraction": 0.3, "resolution-mm": 6})
    signal.signal(signal.SIGINT, before)
    assert jobs.job(job.known.id).state == "running"
    time.sleep(0.5)
    while jobs.job(job.known.id).state == "running":
        jobs.job(job.known.id).stop()
        time.sleep(0.3)
        reap()
    assert jobs.job(job.known.id).state == "stopped"
    with pytest.raises(CranktopoError):
        jobs.job("007")


def test_the_result_of_shape_is_a_design(tmp_path: Path) -> None:
    ran = ended(Jobs(tmp_path), Jobs(tmp_path).start("fatigue", TEXT, {"method": "none"}).known.id)
    job = BenchJob(ran.place, ran.known.model_copy(update={"kind": "shape"}))
    job.out.mkdir()
    shutil.copy(job.place / "design.toml", job.out / "web.toml")
    assert variant_of(job) == TEXT
    assert variant_of(ran) == TEXT, "a check comes back with the design that it was of"
    assert variant_of(BenchJob(ran.place, ran.known.model_copy(update={"kind": "bound"}))) is None


def test_the_words_of_a_job_name_what_governs_and_what_limits_cost(tmp_path: Path) -> None:
    ran = ended(Jobs(tmp_path), Jobs(tmp_path).start("fatigue", TEXT, {"method": "none"}).known.id)
    values = {"pin": {"acceptability": 0.9}, "journal": {"acceptability": 1.2}}
    both = {"closed_form": values, "finite_elements": {**values, "pin": {"acceptability": 0.8}}}
    found = {"safety": 0.8, "verdict": "not accepted", "least_acceptability": 1.15, "fillets": both}
    found |= {"governing_factors": {"pin": "elements", "journal": "polynomials"}}
    told = filled(FatigueResult, {"method": "m53", "fatigue": [found]})
    (ran.place / "stdout.txt").write_text(json.dumps(told), encoding="utf-8")
    lines = job_words(ran)
    assert lines[1] == "pin fillet: 0.9 by polynomials, 0.8 by elements; elements govern"
    assert job_numbers(ran)["m53_pin_elements"] == 0.8
    shape = BenchJob(ran.place, ran.known.model_copy(update={"kind": "shape"}))
    (ran.place / "stdout.txt").write_text(f"{in_width(MET)}\nmore\n", encoding="utf-8")
    shape.out.mkdir()
    price = {"quantity": "bending", "sense": ">=", "goal_percent_per_percent": 1.59}
    prices = [price, *({**price, "goal_percent_per_percent": nothing} for nothing in (0.0, None))]
    told = filled(ShapeResult, {"goal": {"minimise": "mass"}, "prices": prices})
    (shape.out / "shape.json").write_text(json.dumps(told), encoding="utf-8")
    assert job_words(shape) == [MET, "1 % of bending >= costs 1.59 % mass"]


def test_a_note_that_goes_on_in_the_next_line_is_one(tmp_path: Path) -> None:
    lines = [MET, "  part: begins", f"shape: [###---------] 4 of 12, {MET}, about 3 min left"]
    job = finished(tmp_path, "shape", "")
    (job.place / "notes.txt").write_text(in_width("\n".join(lines)), encoding="utf-8")
    assert job.as_json(tmp_path)["notes"] == lines
    assert pace_of(lines[-1]) == (0.25, "about 3 min")


def test_the_pace_of_the_whole_goes_before_those_of_its_parts(tmp_path: Path) -> None:
    whole, part = (
        "loop: [##----------] 2 of 6, about 5 min left",
        "  fit: [######------] 3 of 5, about 3 s left",
    )
    lines = [whole, *[part] * 1000]
    job = finished(tmp_path, "iterate", "")
    (job.place / "notes.txt").write_text("\n".join(lines), encoding="utf-8")
    (job.place / "code").unlink()
    known = {"pid": os.getpid(), "born": psutil.Process().create_time()}
    running = BenchJob(job.place, job.known.model_copy(update=known))
    assert running.as_json()["pace"] == {"share": 1 / 6, "left": "about 5 min"}
    (job.place / "notes.txt").write_text(f"loop: [------------] 1 of 6\n{part}\n", encoding="utf-8")
    assert running.as_json()["pace"] == {"share": 0.0, "left": "about 3 s of this part"}, "not known yet"


def finished(folder: Path, kind: str, printed: object, code: int = 0, words: Sequence[str] = ()) -> BenchJob:
    """A job as it is found when it has ended well."""
    place = folder / f"{1 + len(list(folder.glob('0*'))):03d}"
    place.mkdir(parents=True)
    known = {"id": place.name, "kind": kind, "words": words or [kind, "design.toml"], "started": 0.0}
    for name, text in {
        "job.json": json.dumps(known),
        "stdout.txt": json.dumps(printed),
        "code": str(code),
    }.items():
        (place / name).write_text(text, encoding="utf-8")
    (place / "design.toml").write_text(TEXT, encoding="utf-8")
    return Jobs(folder).job(place.name)


@pytest.mark.parametrize("name", ["stdout.txt", "notes.txt", "code"])
@pytest.mark.parametrize(
    "content", ["[" * 10**5, '{"evaluations": []}', '{"mass": NaN}', "pipe", "/dev/zero"]
)
def test_a_stored_job_that_was_changed_tells_nothing(tmp_path: Path, name: str, content: str) -> None:
    """A pipe that nobody writes to, or a device without an end, held the server for ever."""
    job = finished(tmp_path, "evaluate", {})
    (job.place / "notes.txt").touch()
    (job.place / name).unlink()
    if content == "pipe":
        os.mkfifo(job.place / name)
    elif content == "/dev/zero":
        (job.place / name).symlink_to(content)
    else:
        (job.place / name).write_text(content, encoding="utf-8")
    assert job_words(job) == []
    assert job_numbers(job) == {}
    assert job.as_json()["state"] == ("stopped" if name == "code" else "done")


def test_the_words_of_an_evaluation_and_of_a_shaft(tmp_path: Path) -> None:
    evaluation = {
        "mass_kg": {"throw": 1.5}, "inertia_kg_mm2": 2000.0, "unbalance_kg_mm": 30.0,
        "supports": {"torsion": "free", "bending": "pinned"},
        "torsion": {"free_Nm_per_rad": 136_900.0}, "bending": {"pinned_N_per_mm": 227_200.0},
        "stiffness_per_mass": {"torsion_Nm_per_rad_kg": 9.1e4, "bending_N_per_mm_kg": 1.5e5},
        "error_estimate_percent": {"torsion": 0.42, "bending": 0.61},
    }  # fmt: skip
    job = finished(tmp_path, "evaluate", filled(EvaluationList, {"evaluations": [evaluation]}))
    assert job_words(job) == ["torsion 136.9 kN m/rad, within 0.42 %", "bending 227.2 kN/mm, within 0.61 %"]
    assert job_numbers(job)["torsion"] == 136_900.0
    assert variant_of(job) == TEXT
    bearings = [{"bearing": 2, "largest_N": 31_000.0}, {"bearing": 1, "largest_N": 9_000.0}]
    shaft = {
        "mass_kg": 12.3, "torsion": {"end_to_end_Nm_per_rad": 42_000.0},
        "natural_frequencies_Hz": [250.0, 600.0], "on_bearings": [{"main_bearings": bearings}],
    }  # fmt: skip
    job = finished(tmp_path, "shaft", filled(ShaftAssessment, shaft))
    assert job_words(job) == [
        "whole shaft: 12.3 kg, 42 kN m/rad from end to end",
        "first natural frequency 250 Hz",
        "largest main bearing force 31 kN, bearing 2",
    ]
    assert variant_of(job) is None


def test_the_words_of_jobs_on_parts_begin_with_what_fails_or_was_found(tmp_path: Path) -> None:
    joint = {"name": "rod", "smallest_safety": 0.9, "governing": "yield"}
    job = finished(tmp_path, "bolts", filled(BoltChecks, {"joints": [joint]}))
    assert job_words(job) == ["NOT SAFE: smallest safety by VDI 2230: 0.90, yield of rod."]
    assert variant_of(job) is None
    found = {"start_kg": 4.0, "result_kg": 3.0}
    notch = {"name": "groove", "running_safety": 2.0, "starting_safety": 0.5}
    shaft = {
        "mass_kg": 3.0,
        "largest_deflection_mm": 0.02,
        "redesign": found,
        "notches": [notch],
        "joints": [],
    }
    job = finished(tmp_path, "lighter balancer", filled(BalancerStrength, shaft))
    told = job_words(job)
    assert told[0] == "shaft 4 to 3 kg (-25.0 %), no less safe"
    assert "NOT SAFE: least safety 0.5: groove" in told
    (job.place / "found.toml").write_text(TEXT, encoding="utf-8")
    assert variant_of(job) == TEXT


STEP = {
    "throw_kg": 2.0, "web_kg": 1.0, "torsion_Nm_per_rad": 2e5, "bending_N_per_mm": 3e5,
    "torsion_error_percent": 0.1, "bending_error_percent": 0.1, "transition_mm": 9.0, "overlap_percent": None,
    "removed_percent": None, "seconds": 1.0,
}  # fmt: skip


def test_a_loop_comes_back_as_its_best_web_and_a_table_of_its_steps(tmp_path: Path) -> None:
    first = LoopStep(number=0, **STEP)
    better = LoopStep(number=1, **(STEP | {"throw_kg": 1.6, "torsion_Nm_per_rad": 1.8e5}))
    loop = LoopResult(
        design="mine",
        stop_reason="all 1 steps done",
        least_transition_mm=7.0,
        best_step=1,
        steps=[StepRow.of(first, first, ""), StepRow.of(better, first, "")],
    )
    job = finished(tmp_path, "iterate", "")
    (job.out / "step-01").mkdir(parents=True)
    (job.out / "step-01" / "web.toml").write_text(TEXT, encoding="utf-8")
    write_json(job.out / "iterate.json", loop.as_json())
    assert variant_of(job) == TEXT
    assert job_numbers(job)["torsion_per_mass"] == 1.8e5 / 1.6
    assert job_words(job)[0].startswith("best: step 1, torsional stiffness per mass +12.5 %, mass -20.0 %")
    heads, *rows = job_table(job)
    assert heads[:3] == ["step", "mass %", "torsion %"]
    assert [row[:3] for row in rows] == [["0", "100.0", "100.0"], ["1", "80.0", "90.0"]]
    none = loop.model_copy(update={"best_step": None})
    write_json(job.out / "iterate.json", none.as_json())
    assert variant_of(job) is None
    assert job_words(job)[0].startswith("no step beats the original web")


def test_an_accuracy_study_that_is_stopped_keeps_what_is_solved(tmp_path: Path) -> None:
    words = command_words("accuracy", "design.toml", {"budget": "60s"})
    assert words == ("accuracy", "design.toml", "--budget=60s", "--out", "out")
    job = finished(tmp_path, "accuracy", "", code=130)
    assert (job.state, job.has_result, job.resumable) == ("stopped", False, False)
    cheapest = {"ladder": "judge", "accuracy_percent": 2.0, "rung": "uniform 9.45 mm", "seconds": 4.25}
    study = filled(StudyResult, {"rungs": [], "limits": {}, "recommendations": [cheapest], "failures": ["x"]})
    job.out.mkdir()
    write_json(job.out / "accuracy.json", study)
    assert job.has_result
    assert job_words(job)[-1] == "no answer: x"
    row = ["2 %", "body-fitted evaluation", "uniform 9.45 mm", "4.2"]
    assert job_table(job) == [["accuracy", "study", "cheapest level", "time s"], row]
    assert variant_of(job) is None
    job.note_result("-", job_words(job), {}, job_table(job))
    assert Jobs(tmp_path).job(job.known.id).as_json()["table"][1] == tuple(row)


def test_a_lighter_rod_is_a_command_with_a_file_of_its_own(tmp_path: Path) -> None:
    words = command_words("lighter rod", "design.toml", {"method": "lsa"})
    assert words == ("rod", "design.toml", "--lighter=found.toml", "--method=lsa", "--json")
    job = finished(tmp_path / "bench" / "mine" / "jobs", "lighter rod", "", words=words)
    design = "bench/mine/jobs/001/design.toml"
    line = f"cranktopo rod {design} --lighter=lighter-rod-001.toml --method=lsa --json"
    assert job.line(tmp_path) == line, "as it is typed in the folder"


def test_a_job_on_the_run_of_another_names_it_as_it_is_typed_in_the_folder(tmp_path: Path) -> None:
    jobs = Jobs(tmp_path / "bench" / "mine" / "jobs")
    finished(tmp_path / "bench" / "mine" / "jobs", "optimise", "")
    with pytest.raises(CranktopoError, match=r"run: job 009|there is no such job"):
        jobs.start("remodel", TEXT, {}, run="009")
    job = jobs.start("extract", TEXT, {}, run="001")
    assert job.known.words == ("extract", "../001/out", "--out", "surface.stl")
    assert job.line(tmp_path) == "cranktopo extract bench/mine/jobs/001/out --out extract-002.stl"
    told = ended(jobs, job.known.id).as_json()
    assert told["state"] == "failed", "this run has no files"
    failed = finished(tmp_path / "bench" / "mine" / "jobs", "optimise", "", code=3)
    with pytest.raises(CranktopoError, match="is no finished optimise job"):
        jobs.start("remodel", TEXT, {}, run=failed.known.id)
