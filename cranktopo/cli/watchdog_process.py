"""Process that tells that a command is at work while the command itself can tell nothing.

Native code that holds the interpreter's lock, as a mesher does, stops every thread of the command. This file
runs in an interpreter of its own, by its path and without packages, so that it starts in 10 ms.
"""

import os
import select
import sys
import time

_STEP, _MISSED = 1 / 24, 1 / 4
"""Over the longest wait: between two looks; without a beat until the command counts as unable to speak."""


def waited(seconds: float) -> str:
    """Return how long work lasts, another text at each line: `40 s`, `12 min 25 s`, `3 h 20 min 5 s`."""
    minutes, left = divmod(round(seconds), 60)
    if seconds < 90:
        return f"{seconds:.0f} s"
    hours = f"{minutes // 60} h " if minutes >= 60 else ""
    return f"{hours}{minutes % 60} min {left} s"


class Watchdog:
    """The last line of a command, and the line that is due when its silence has lasted too long.

    Attributes:
        longest_s: seconds that may pass between two lines.
    """

    def __init__(self, longest_s: float) -> None:
        self.longest_s = longest_s
        self._heard = self._last_line_s = self._began = 0.0
        self._name = ""

    def hear(self, beat: str, now: float) -> None:
        """Take a beat: seconds since the last line of the command, seconds of its present work, its name."""
        silent_s, worked_s, self._name = beat.split(" ", 2)
        self._heard, self._last_line_s, self._began = now, now - float(silent_s), now - float(worked_s)

    def line(self, now: float) -> str:
        """Return the line that is due; empty where none is, as while beats come or no work has a name."""
        silent = now - self._last_line_s >= (1 - _STEP) * self.longest_s
        if not self._name or not silent or now - self._heard < _MISSED * self.longest_s:
            return ""
        self._last_line_s = now
        return f"{self._name}: {waited(now - self._began)} so far\n"


def watch(longest_s: float) -> None:
    """Read beats from stdin, a line each, and tell lines on stderr; end with stdin."""
    watchdog, rest = Watchdog(longest_s), b""
    while True:
        if select.select([0], [], [], _STEP * longest_s)[0]:
            part = os.read(0, 1 << 16)
            if not part:
                return
            *beats, rest = (rest + part).split(b"\n")
            for beat in beats[-1:]:
                watchdog.hear(beat.decode(), time.monotonic())
        os.write(2, watchdog.line(time.monotonic()).encode())


if __name__ == "__main__":
    watch(float(sys.argv[1]))
