"""Constants and fields of messages by their names: `demo_msgs.msg.Topics.STATE`, `demo_msgs::msg::Topics::STATE`."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from kg.extract.definitions import fields_of
from kg.facts import Field, Resolution
from kg.symbolic.values import Number, Text, Truth, Value

if TYPE_CHECKING:
    from kg.corpus.reading import Reader


class Constants:
    """The constants and the fields of the messages that a reader of sources finds."""

    def __init__(self, reader: Reader) -> None:
        self._reader = reader
        self._cache: dict[tuple[str, str], dict[str, Field]] = {}

    def find(self, names: tuple[str, ...]) -> Value | None:
        """Return the constant of a full name, `(package, [msg,] message, constant)`; None if there is none."""
        field = self._field(names) if names[-1] == names[-1].upper() else None
        return _value(field) if field is not None else None

    def type_of_field(self, names: tuple[str, ...]) -> str | None:
        """Return the type of the field of a full name, as definitions write it; None if there is none."""
        field = self._field(names)
        return field.type if field is not None and field.constant is None else None

    def _field(self, names: tuple[str, ...]) -> Field | None:
        package, *inner, message, name = names if len(names) > 2 else ("", "", "")  # noqa: PLR2004 - with a package
        if inner not in ([], ["msg"]):
            return None
        key = (package, message)
        if key not in self._cache:
            file = self._reader.workspace.definition(package, message, "msg")
            content = self._reader.read(file) if file is not None else None
            fields = fields_of(content.decode(), package) if content is not None else []
            self._cache[key] = {field.name: field for field in fields}
        return self._cache[key].get(name)


def _value(field: Field) -> Value | None:
    if field.constant is None:
        return None
    if field.type in ("string", "wstring"):
        return Text.of(field.constant, Resolution.CONSTANT)
    if field.constant in ("true", "false"):
        return Truth(field.constant == "true")
    with suppress(ValueError):
        return Number(float(field.constant) if "." in field.constant else int(field.constant), field.constant)
    return None
