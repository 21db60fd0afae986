"""Pictures of every page and sheet that a command writes, and the checks that nothing of them is cut.

    python -m tests.studies.page_pictures FOLDER [NAME ...]

Makes the pages with cheap settings, or those of these names alone, and keeps what the folder has already.
Every page is pictured as at a desk, light and dark, on a phone and on paper, every sheet as it is (PDF: by
pdftoppm). What sticks out, what lies over something else and what paper cuts is printed.
"""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

from cranktopo.design.loading import design_text
from tests.browser.conftest import opened_browser
from tests.studies.bench_pictures import CUT
from tests.studies.page_checks import found_in_plots, found_on_paper

ROOT = Path(__file__).parents[2]
MOST_PX = 7000
"""Height of a picture that the browser takes at once: software rendering repeats what lies below."""
SIZES: dict[str, dict[str, Any]] = {
    "desk": {"viewport": {"width": 1280, "height": 800}},
    "dark": {"viewport": {"width": 1280, "height": 800}, "color_scheme": "dark"},
    "phone": {"viewport": {"width": 390, "height": 844}, "is_mobile": True, "has_touch": True},
}
OPTIMISE = "optimise mikron-iiic-plain --resolution-mm 4.5 --max-iterations 12"
COMPARE = "compare mikron-iiic-hollow mikron-iiic-rounded --baseline mikron-iiic --element-size-mm 12"
PRINTED = "compare opposed-piston-variant-1 opposed-piston-variant-2 --baseline opposed-piston --no-bound"
COMMANDS = {
    "loads": "loads car-diesel --plot loads.svg",
    "loads-sweep": "loads mikron-iiic --speed 1000:2000:500 --plot loads-sweep.png",
    "film": "film car-diesel --plot film.svg",
    "balance": "balance mikron-iiic --report balance.html",
    "balance-diesel": "balance car-diesel --report balance-diesel.html",
    "balance-gas": "balance industrial-gas --propose 50% --report balance-gas.html",
    "vibration": "vibration car-diesel --element-size-mm 14 --report vibration.html",
    "vibration-gas": "vibration industrial-gas --element-size-mm 30 --misfire worst --run-up 10s"
    " --report vibration-gas.html",
    "modes": "modes mikron-iiic --element-size-mm 24 --speeds 700:2800:7 --report modes.html",
    "shaft": "shaft mikron-iiic-plain --speeds 900:2100:3 --report shaft.html --fillet-fraction 0.5",
    "shaft-fkm": "shaft car-diesel --method fkm --fillet-fraction 0.5 --report shaft-fkm.html",
    "optimise": f"{OPTIMISE} --out optimise",
    "optimise-goal": f"{OPTIMISE} --minimise mass --no-bound --out optimise-goal",
    "remodel": "remodel optimise --cell-mm 3 --no-evaluation",
    "fatigue-run": "fatigue optimise/remodel/web.toml --fillet-fraction 0.5 --out fatigue-run",
    "report-stress": "report optimise --stress --out report-stress.html",
    "iterate": "iterate mikron-iiic-plain --steps 2 --resolution-mm 4.5 --no-shape --no-bound --out iterate",
    "accuracy": "accuracy mikron-iiic-plain --budget 30s --out accuracy",
    "sweep": "sweep mikron-iiic --vary web.width_mm=46:56:4 --vary throw.crankpin.fillet_mm=2,2.5"
    " --element-size-mm 12 --workers 1 --out sweep",
    "compare": f"{COMPARE} --report compare.html --plot compare.svg",
    "compare-fatigue": f"{COMPARE} --fatigue lsa --no-bound --report compare-fatigue.html",
    "compare-printed": f"{PRINTED} --element-size-mm 12 --report compare-printed.html --stress",
    "fatigue": "fatigue mikron-iiic-hollow --baseline mikron-iiic --fillet-fraction 0.5 --out fatigue",
    "fatigue-fkm": "fatigue car-diesel --method fkm --loads cycle --fillet-fraction 0.5 --out fatigue-fkm",
    "dossier": "fatigue car-diesel --method m53 --fillet-fraction 0.5 --report dossier.html",
    "dossier-pdf": "fatigue car-diesel --method m53 --fillet-fraction 0.5 --report dossier.pdf",
    "rod": "rod mikron-iiic-rod --drawing rod.pdf",
    "rod-h": "rod mikron-iiic-rod-h --drawing rod-h.svg",
    "rod-fea": "rod mikron-iiic-rod-i --fea --element-size-mm 9 --out rod-fea --drawing rod-i.png",
    "balancer": "balancer balancer-shaft --drawing balancer.pdf",
    "balancer-new": "balancer balancer-shaft --redesign balancer-new.toml --drawing balancer-new.svg",
    "crank-end": "drawing mikron-iiic-crank crank-end.pdf",
    "crank": "drawing forged.toml crank.pdf",
    "crank-gas": "drawing industrial-gas crank-gas.svg",
    "half": "export mikron-iiic half.pdf",
    "half-forged": "export forged.toml half-forged.pdf",
    "raw": "export forged.toml raw.svg --part raw",
    "step": "export mikron-iiic-crank crank.step --part crankshaft",
    "import": "import crank.step --out import",
    **{f"sketch-{part}": f"designs sketch {part} sketch-{part}.svg" for part in
       ("throw", "drilling", "web", "bevel", "pocket", "counterweight", "crank")},
}  # fmt: skip
"""What is made, by its name, in this order: some need what others left."""
DONE = (0, 5, 6)
"""Exit codes of commands that wrote what was asked for."""
FORGING = "[forging]\nallowance_mm = 2.0\ndraft_deg = 5.0\nflash_mm = 2.0\n\n[effects]\n"


def main(folder: Path, names: list[str]) -> None:
    """Make the pages, take the pictures, and tell what is wrong with them."""
    pictures = folder / "pictures"
    pictures.mkdir(parents=True, exist_ok=True)
    forged = design_text("car-diesel").replace("[effects]\n", FORGING, 1)
    (folder / "forged.toml").write_text(forged, encoding="utf-8")
    for name in names or COMMANDS:
        _make(folder, name)
    with opened_browser() as browser:
        for page in sorted(folder.rglob("*.html")):
            _pictured(browser, page, pictures / _name(folder, page))
        for sheet in sorted(folder.rglob("*.svg")):
            _sheet(browser, sheet, pictures / _name(folder, sheet))
    for sheet in sorted(set(folder.rglob("*.pdf")) - set(pictures.glob("*.pdf"))):
        _rastered(sheet, pictures / _name(folder, sheet))


def _make(folder: Path, name: str) -> None:
    mark = folder / f"{name}.done"
    if mark.exists():
        return
    words = [sys.executable, "-m", "cranktopo", *shlex.split(COMMANDS[name])]
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    ended = subprocess.run(words, cwd=folder, env=env, capture_output=True, text=True, check=False)
    if ended.returncode in DONE:
        mark.touch()
    else:
        print(f"{name}: {ended.stderr.splitlines()[-1:]}")


def _name(folder: Path, file: Path) -> str:
    return "-".join(file.relative_to(folder).with_suffix("").parts)


def _pictured(browser: Any, file: Path, to: Path) -> None:
    for kind, window in SIZES.items():
        page = browser.new_context(**window).new_page()
        page.goto(file.resolve().as_uri())
        page.wait_for_timeout(700)  # for the 3D view
        _whole(page, f"{to}-{kind}")
        found = page.evaluate(CUT)
        if kind == "desk":
            page.pdf(path=f"{to}.pdf", prefer_css_page_size=True)
            found += [*found_in_plots(page), *found_on_paper(page)]
        for line in found:
            print(f"{to.name}, {kind}: {line}")
        page.context.close()
    _rastered(Path(f"{to}.pdf"), Path(f"{to}-paper"))


def _whole(page: Any, to: str) -> None:
    width, height = page.viewport_size["width"], page.evaluate("document.documentElement.scrollHeight")
    for number, top in enumerate(range(0, height, MOST_PX)):
        clip = {"x": 0, "y": top, "width": width, "height": min(MOST_PX, height - top)}
        page.screenshot(path=f"{to}-{number}.png", full_page=True, clip=clip)


def _sheet(browser: Any, file: Path, to: Path) -> None:
    page = browser.new_context(viewport={"width": 1600, "height": 1200}).new_page()
    page.goto(file.resolve().as_uri())
    page.screenshot(path=f"{to}.png")
    page.context.close()


def _rastered(file: Path, to: Path) -> None:
    subprocess.run(["pdftoppm", "-r", "80", "-png", str(file), str(to)], check=False)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
