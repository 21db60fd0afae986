"""Run the examples again and put their pictures into the gallery, each below 60 kB.

python docs/record_examples.py
python docs/record_examples.py 04 09
"""

from __future__ import annotations

import re
import runpy
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib
from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = ROOT / "examples"
PICTURES = ROOT / "docs" / "pages" / "images" / "examples"
WIDTH, COLOURS = 1200, 64
"""Most pixels across a picture of pixels, and its colours."""


def run_example(script: Path, out: Path) -> Path:
    """Run an example and return the picture that it wrote, which has the script's name."""
    before = sys.argv
    sys.argv = [str(script), str(out)]
    try:
        runpy.run_path(str(script), run_name="__main__")
    finally:
        sys.argv = before
        matplotlib.pyplot.close("all")
    (picture,) = (path for path in out.glob(f"{script.stem}.*") if path.suffix in (".svg", ".png"))
    return picture


def keep(picture: Path) -> None:
    """Put a picture into the gallery: vectors as they are, pixels fewer and of few colours."""
    to = PICTURES / picture.name
    if picture.suffix == ".svg":
        text = picture.read_text(encoding="utf-8")
        to.write_text(re.sub(r"(?s) *<dc:date>.*?</dc:date>\n", "", text), encoding="utf-8")
        return
    image = Image.open(picture).convert("RGB")
    image.thumbnail((WIDTH, WIDTH), Image.Resampling.LANCZOS)
    image.quantize(COLOURS, dither=Image.Dither.NONE).save(to, optimize=True)


def main(numbers: list[str]) -> None:
    """Run the examples of these numbers, or all of them."""
    matplotlib.use("agg")
    matplotlib.rcParams["svg.hashsalt"] = "examples"  # an unchanged picture is the same file
    PICTURES.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as folder:
        for script in sorted(EXAMPLES.glob("[0-9]*.py")):
            if not numbers or script.name[:2] in numbers:
                keep(run_example(script, Path(folder)))


if __name__ == "__main__":
    main(sys.argv[1:])
