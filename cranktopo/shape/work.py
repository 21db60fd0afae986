"""What a shape optimisation tells while it works, and what it keeps so that it can be continued."""

from __future__ import annotations

from collections.abc import Callable, MutableMapping
from dataclasses import dataclass, field
from typing import Any

from cranktopo.evaluate.evaluation import Info

Json = dict[str, Any]


@dataclass(frozen=True)
class Work:
    """Progress and memory of one optimisation.

    Attributes:
        info: called with lines of progress.
        kept: results of finished parts by name, plain data; filled as the work goes on. With what an
            interrupted optimisation kept, the same parts are not done again, and the result is the same.
        check: called between steps; raises KeyboardInterrupt where Ctrl-C was pressed.
    """

    info: Info = lambda _: None
    kept: MutableMapping[str, Json] = field(default_factory=dict)
    check: Callable[[], None] = lambda: None

    def once(self, name: str, make: Callable[[], Json]) -> Json:
        """The result of a part, made only if it is not kept yet."""
        if name not in self.kept:
            self.kept[name] = make()
            self.check()
        return self.kept[name]
