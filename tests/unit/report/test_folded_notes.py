"""Notes of a drawing stay within their column."""

from __future__ import annotations

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from cranktopo.base.units import MM_PER_INCH
from cranktopo.report.drafting import TEXT_SIZE, folded

LONG = (
    "42CrMo4: Rm at least 900 MPa, Re at least 650 MPa, quenched and tempered, EN ISO 683-2 +QT, 40 to 100",
    "ALL EDGES BROKEN 0.5 MM; MAGNETIC PARTICLE TEST OF ALL FILLETS AND OUTLETS TO EN ISO 9934, LEVEL 2",
    "short",
)


def test_lines_fit_their_width_of_paper() -> None:
    """By the extent that matplotlib draws, in the largest size of notes."""
    width_mm = 108.0
    lines = folded(LONG, width_mm)
    figure = Figure(figsize=(20, 2))
    renderer = FigureCanvasAgg(figure).get_renderer()
    for line in lines:
        text = figure.text(0, 0.5, line, fontsize=TEXT_SIZE)
        extent_mm = text.get_window_extent(renderer).width / figure.dpi * MM_PER_INCH
        assert extent_mm <= width_mm
    assert lines[-1] == "short"
    assert "".join(lines).replace(" ", "") == "".join(LONG).replace(" ", "")
    assert len(lines) > len(LONG)
