"""Texts of ROS 2 launch: parts that are joined when an action is executed, and the conditions that they give."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["Condition", "Part", "Substitution", "Text", "join", "unknown_text"]

_MOST_PARTS: Final = 2_000


@dataclass(frozen=True, slots=True)
class Substitution:
    """A part of a text that is known only when it is executed.

    `kind` is that of the XML form: `var`, `env`, `find-pkg-share`, `find-pkg-prefix`, `find-exec`, `dirname`,
    `filename`, `eval`, `command`, `anon`, `not`, `and`, `or`, `any`, `all`, `equals`, `not-equals`, `if`,
    `file-content`, `path-join`, `local`, `unknown` (then `reason` tells why). `arguments` are its operands in order; a
    missing default is left out. Two have no form in XML: `replaced-file` gives the name of a copy of a file (operands:
    the file, whether texts are replaced, and old and new texts in turn), `rewritten-file` that of a copy of `file`, a
    `ParameterFile`.
    """

    kind: str
    arguments: tuple[Text, ...] = ()
    reason: str | None = None
    file: object = None


Part: TypeAlias = str | Substitution
Text: TypeAlias = tuple[Part, ...]


@dataclass(frozen=True, slots=True)
class Condition:
    """`value` has to be true (`IfCondition`), or not with `negated` (`UnlessCondition`); None: it cannot be known."""

    value: Text | None
    negated: bool = False
    written: str = ""

    @property
    def words(self) -> str:
        """What has to hold, in the words of the file."""
        text = self.written or "what is known only when it runs"
        return f"not {text}" if self.negated else text


def unknown_text(reason: str) -> Text:
    """Return the text that cannot be known."""
    return (Substitution("unknown", reason=reason),)


def join(parts: Sequence[Part]) -> Text:
    """Return parts with neighbouring plain texts joined."""
    merged: list[Part] = []
    for part in parts[:_MOST_PARTS]:
        if isinstance(part, str) and merged and isinstance(merged[-1], str):
            merged[-1] += part
        elif part != "":
            merged.append(part)
    if len(parts) > _MOST_PARTS:
        merged.append(Substitution("unknown", reason="the text has too many parts"))
    return tuple(merged)
