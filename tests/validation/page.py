"""Write the tables and the pictures of docs/pages/validation.md: `python -m tests.validation.page`."""

from __future__ import annotations

import re
from pathlib import Path

from tests.validation import concentration_map, free_moments, shafts, stiffness_map
from tests.validation.table import input_table, table

PAGES = Path(__file__).parents[2] / "docs" / "pages"
IMAGES = PAGES / "images"


def tables() -> dict[str, str]:
    """Markdown by the name of its place in the page."""
    return {
        "v16-inputs": input_table(free_moments.inputs()),
        "v16": table(row for name in free_moments.CASES for row in free_moments.rows(name)),
        "cbr600-inputs": input_table(shafts.cbr600_inputs()),
        "cbr600": table(shafts.cbr600_rows()),
        "mwm-inputs": input_table(shafts.mwm_inputs()),
        "mwm": table(shafts.mwm_rows()),
        "stiffness": stiffness_map.table(),
        "concentration": concentration_map.table(),
    }


def filled(page: str) -> str:
    """The page with its tables as they are now."""
    for name, text in tables().items():
        place = re.compile(rf"(<!-- {name} -->\n).*?(\n<!-- until here -->)", re.DOTALL)
        page, count = place.subn(lambda found, text=text: f"{found[1]}{text}{found[2]}", page)
        assert count == 1, name
    return page


def draw(path: Path) -> None:
    """Vibratory torque over the speed, printed and ours."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context({"svg.hashsalt": "cranktopo", "svg.fonttype": "none"}):
        figure = Figure(figsize=(8.0, 3.2), layout="constrained")
        for axes, section in zip(figure.subplots(1, 2), shafts.SECTIONS, strict=True):
            curve = shafts.mwm_curve(section)
            axes.plot(curve.speed_rpm, curve.printed_Nm, "k.", ms=3, label="Mendes et al. 2008")
            axes.plot(curve.speed_rpm, curve.ours_Nm, color="tab:blue", label="cranktopo")
            axes.set(title=section, xlabel="speed, rpm", ylabel="vibratory torque, N m", ylim=(0, None))
            axes.legend(frameon=False)
        figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    page = PAGES / "validation.md"
    page.write_text(filled(page.read_text(encoding="utf-8")), encoding="utf-8")
    draw(IMAGES / "validation-torque.svg")
    stiffness_map.draw(IMAGES / "validation-stiffness.svg")
    concentration_map.draw(IMAGES / "validation-concentration.svg")
