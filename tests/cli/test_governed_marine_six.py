"""A six-cylinder marine engine that elements alone nearly accept, and the polynomials of the rule do not."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import ExitCode

DESIGN = str(Path(__file__).parents[1] / "data" / "marine-six.toml")


@pytest.mark.slow
def test_the_lower_of_both_sets_governs_and_the_crank_is_not_accepted(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """All ratios of the throw are valid for the polynomials; elements have more at the journal's fillet."""
    assert main(["fatigue", DESIGN, "--method", "m53", "--quiet", "--json"]) == ExitCode.CRITERION_NOT_MET
    (found,) = json.loads(capsys.readouterr().out)["fatigue"]
    assert not found["outside_validity"]
    assert not found["not_judged"]
    assert found["governing_factors"] == {"pin": "elements", "journal": "polynomials"}
    pin, journal = (
        {kind: found["fillets"][kind][fillet]["acceptability"] for kind in ("closed_form", "finite_elements")}
        for fillet in ("pin", "journal")
    )
    assert journal["closed_form"] < journal["finite_elements"] < found["least_acceptability"]
    assert found["safety"] == min(*pin.values(), *journal.values()) == journal["closed_form"]
    assert (found["accepted"], found["verdict"]) == (False, "not accepted")
