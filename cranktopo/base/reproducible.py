"""Means to make repeated work the same: the seed of random choices, and the date that files carry."""

from __future__ import annotations

import os
from datetime import UTC, datetime

from cranktopo.base.errors import invalid

SEED = 0
"""Of every random choice: starts of the re-model and of the eigenvalue bound, samples of its shape error."""


def time_of_writing(started: datetime | None = None) -> datetime:
    """Return the time that a file says it was written, in UTC to the second.

    SOURCE_DATE_EPOCH, or the time when the work was started that it is a part of, make files repeatable:
    work that was interrupted and resumed writes the same bytes. Without both it is now.

    Source: https://reproducible-builds.org/specs/source-date-epoch/

    Raises:
        CranktopoError: SOURCE_DATE_EPOCH is not a number of seconds.
    """
    seconds = os.environ.get("SOURCE_DATE_EPOCH")
    if not seconds:
        return (started or datetime.now(UTC)).astimezone(UTC).replace(microsecond=0)
    try:
        return datetime.fromtimestamp(int(seconds), UTC)
    except (ValueError, OverflowError, OSError):
        raise invalid(
            "SOURCE_DATE_EPOCH", seconds, "must be seconds since 1970", "Unset it, or correct it."
        ) from None
