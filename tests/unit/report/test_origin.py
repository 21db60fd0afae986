"""The origin on a page: a command that can be typed as it stands there."""

import shlex

from cranktopo.report.page import origin_rows
from cranktopo.runs.manifest import new_manifest


def test_the_command_keeps_its_quotes() -> None:
    words = ("cranktopo", "shape", "my engine.toml", "--limit", "fatigue_safety >= 1.3")
    manifest = new_manifest(run="out", design="", command=words, scene={}, options={}, inputs={})
    assert tuple(shlex.split(dict(origin_rows(manifest))["command"])) == words
