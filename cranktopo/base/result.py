"""Results of stages: frozen models that are their own JSON, written by one stage and read by the next."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import AfterValidator, ConfigDict, Field, ValidationError

from cranktopo.base.described import Described
from cranktopo.base.errors import CranktopoError
from cranktopo.base.faults import faults_of
from cranktopo.base.files import is_inside, read_json


def left_out(value: object) -> bool:
    """Tell whether an optional key stays out of the JSON."""
    return value is None


UNLESS_NONE: Any = Field(default=None, exclude_if=left_out)
"""Default of a key that the JSON has only where there is a value; elsewhere None is written as null."""


def _in_folder(name: str) -> str:
    if not is_inside(name):
        raise ValueError("leads out of its folder")
    return name


FileName = Annotated[str, AfterValidator(_in_folder)]
"""Name of a file in the folder of a result or below it."""


def _listed(value: Any) -> Any:
    """Return plain data with lists for tuples, as JSON has them."""
    if isinstance(value, dict):
        return {key: _listed(one) for key, one in value.items()}
    return [_listed(one) for one in value] if isinstance(value, list | tuple) else value


class Result(Described):
    """The result of a stage, which its command prints with `--json`: fields are keys, units in their names.

    Keys that a newer version added are ignored when a file is read.
    """

    model_config = ConfigDict(
        frozen=True,
        extra="ignore",
        serialize_by_alias=True,
        validate_by_name=True,
    )

    def as_json(self) -> dict[str, Any]:
        """Return the result as plain data, keys in the order of the fields, as a file of it is read."""
        return {name: _listed(value) for name, value in self.model_dump(mode="python").items()}

    @classmethod
    def of_json(cls, data: Mapping[str, Any], where: str) -> Self:
        """Return the result that plain data of a place such as `run 'runs/a'` hold; raises CranktopoError."""
        try:
            return cls.model_validate(data)
        except ValidationError as error:
            raise CranktopoError(
                f"{where}: {faults_of(error)[0]}.",
                hint="It was written by another version or damaged; make it again.",
            ) from None

    @classmethod
    def read(cls, path: Path) -> Self:
        """Return the result that a JSON file holds; raises CranktopoError."""
        return cls.of_json(read_json(path), f"'{path}'")
