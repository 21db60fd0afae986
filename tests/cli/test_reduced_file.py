"""`cranktopo export FILE.npz --part reduced`: what it writes, and the lines that refuse it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import ExitCode
from cranktopo.design.loading import designs_folder
from cranktopo.tasks.export import reduced

MIKRON = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        ("a.npz", ExitCode.USAGE, "--part throw: .npz is for --part reduced: give that, or another ending"),
        ("a.step --part reduced", ExitCode.USAGE, "must end in .npz. Name it a.npz."),
        ("a.npz --part reduced --throw 2", ExitCode.USAGE, "--part reduced is all throws: leave it out"),
        ("a.npz --part reduced --facet-mm 2", ExitCode.USAGE, "--facet-mm is the size of STL facets"),
    ],
)
def test_wrong_use_ends_in_a_line(
    words: str,
    code: ExitCode,
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["export", "mikron-iiic-plain", *words.split()]) == code
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("fillet_mm = 2.5", "fillet_mm = 0", "fillet_mm = 0: the stress at a sharp edge is singular"),
        ("[engine]\n", "[shaft]\nthrow_loss_factor = 0.0\n[engine]\n", "shaft.throw_loss_factor = 0"),
        (
            "[engine.masses]",
            "[engine.arrangement]\nlayout = 'V'\nbank_angle_deg = 90.0\npin_splay_deg = -20.0\n"
            "throw_angles_deg = [0, 180]\n[engine.masses]",
            "engine.arrangement.pin_splay_deg = -20.0: split pins are not modelled here",
        ),
    ],
)
def test_a_shaft_that_is_not_modelled_is_refused(
    old: str, new: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert old in MIKRON
    design = tmp_path / "mine.toml"
    design.write_text(MIKRON.replace(old, new), encoding="utf-8")
    code = main(["export", str(design), str(tmp_path / "a.npz"), "--part", "reduced", "--quiet"])
    assert code == ExitCode.INVALID_INPUT
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line
    assert list(tmp_path.iterdir()) == [design]


@pytest.mark.slow
def test_the_command_writes_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """On a coarse mesh; twice, the second time by force."""
    write = reduced.export_reduced
    monkeypatch.setattr(reduced, "export_reduced", lambda target, file: write(target, file, 2.0))
    file = tmp_path / "shaft.npz"
    words = ["export", "mikron-iiic-plain", str(file), "--part", "reduced"]
    assert main(words) == ExitCode.DONE
    told = capsys.readouterr()
    assert told.out.startswith(f"{file}: reduced model of the shaft, 128 coordinates, stress at ")
    assert "stresses on the fillets by the coordinates of the shaft" in told.err
    first = file.read_bytes()
    assert main(words) == ExitCode.USAGE
    assert "exists. Give --force to replace it." in capsys.readouterr().err
    assert main([*words, "--force"]) == ExitCode.DONE
    with np.load(file, allow_pickle=False) as arrays:
        assert str(arrays["design"]) == "mikron-iiic-plain"
    assert file.stat().st_size == len(first)
