"""Jobs are commands in processes of their own: they end, fail and are found again whoever started them."""

from __future__ import annotations

import json
import shutil
import time
from pathlib import Path

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import design_text
from cranktopo.tasks.bench.jobs import BenchJob, Jobs, reap
from cranktopo.tasks.bench.results import job_numbers, job_words, variant_of

TEXT = design_text("mikron-iiic-plain")


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
    jobs = Jobs(tmp_path)
    job = jobs.start("optimise", TEXT, {"volume-fraction": 0.3, "resolution-mm": 6})
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
    (ran.place / "stdout.txt").write_text(json.dumps({"method": "m53", "fatigue": [found]}), encoding="utf-8")
    lines = job_words(ran)
    assert lines[1] == "pin fillet: 0.9 by polynomials, 0.8 by elements; elements govern"
    assert job_numbers(ran)["m53_pin_elements"] == 0.8
    shape = BenchJob(ran.place, ran.known.model_copy(update={"kind": "shape"}))
    (ran.place / "stdout.txt").write_text("met: mass -5.0 %\nmore\n", encoding="utf-8")
    shape.out.mkdir()
    price = {"quantity": "bending", "sense": ">=", "goal_percent_per_percent": 1.59}
    told = {"goal": {"minimise": "mass"}, "prices": [price]}
    told["prices"] += [{**price, "goal_percent_per_percent": nothing} for nothing in (0.0, None)]
    (shape.out / "shape.json").write_text(json.dumps(told), encoding="utf-8")
    assert job_words(shape) == ["met: mass -5.0 %", "1 % of bending >= costs 1.59 % mass"]
