"""`cranktopo shaft` chains the throw that the effects plan leaves, as every other command judges it."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from cranktopo.cli.main import main
from cranktopo.scene.loading import designs_folder

MIKRON = (designs_folder() / "mikron-iiic.toml").read_text(encoding="utf-8")
STEEL_KG_PER_MM3 = 7.85e-6


def shaft(folder: Path, effects: str, capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    path = folder / "mine.toml"
    assert "[effects]\n" in MIKRON
    path.write_text(MIKRON.replace("[effects]\n", f"[effects]\n{effects}\n"), encoding="utf-8")
    assert main(["shaft", str(path), "--element-size-mm", "16", "--json", "--quiet"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    data: dict[str, Any] = json.loads(out)
    return data


def test_shaft_obeys_the_effects_plan(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Closed form: four throws, each bore 24 mm wide through its journal and both 19 mm webs."""
    bored = shaft(tmp_path, 'bores = "on"\nfillets = "off"', capsys)
    solid = shaft(tmp_path, 'bores = "off"\nfillets = "off"', capsys)
    length = (40.0 + 2 * 19.0) + (36.0 + 2 * 19.0)
    missing = 4 * STEEL_KG_PER_MM3 * math.pi / 4 * 24.0**2 * length
    assert solid["mass_kg"] - bored["mass_kg"] == pytest.approx(missing, rel=1e-6)
    assert solid["torsion"]["end_to_end_Nm_per_rad"] > 1.02 * bored["torsion"]["end_to_end_Nm_per_rad"]
