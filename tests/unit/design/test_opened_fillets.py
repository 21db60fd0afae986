"""A bore that ends in the other journal's fillet is told before anything is judged there."""

from __future__ import annotations

import pytest

from cranktopo.app.main import main
from cranktopo.design.loading import builtin_designs, load_scene
from cranktopo.design.opened_fillets import bore_remarks


@pytest.mark.parametrize(("apart_mm", "opens"), [(34.0, True), (35.4, True), (35.6, False), (48.0, False)])
def test_a_bore_within_the_fillets_reach(apart_mm: float, opens: bool) -> None:
    """Bores of 24 mm, fillets that reach to 21 + 2.5 mm: 35.5 mm apart, they just touch."""
    plain = load_scene("mikron-iiic-plain")
    throw = plain.throw.model_copy(update={"radius_mm": apart_mm})
    found = bore_remarks(plain.model_copy(update={"throw": throw}))
    names = ("the bore of the crankpin", "the bore of the main journal") if opens else ()
    assert len(found) == len(names)
    assert all(one.startswith(f"{name} opens in the fillet") for one, name in zip(found, names, strict=True))


def test_plan_tells_it_first(capsys: pytest.CaptureFixture[str]) -> None:
    opened = [name for name in builtin_designs() if bore_remarks(load_scene(name))]
    assert opened == ["opposed-piston-variant-1", "opposed-piston-variant-2"]
    assert main(["plan", opened[0]]) == 0
    assert "opens in the fillet of the main journal, with sharp edges" in capsys.readouterr().err
