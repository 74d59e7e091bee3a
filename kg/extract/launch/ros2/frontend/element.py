"""What the XML and the YAML of launch files have in common: elements with attributes and children.

Source: `launch.frontend.Entity`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["Attribute", "Element", "Malformed"]

Attribute = str | list[str]


class Malformed(Exception):  # noqa: N818  (it says what the file is)
    """An element breaks the rules of launch files."""

    def __init__(self, message: str, line: int) -> None:
        super().__init__(message)
        self.message = message
        self.line = line


@dataclass(slots=True)
class Element:
    """An action, or a part of one, as it is written; values of YAML that are no texts are written as YAML.

    `typed` are the names of attributes that have a value of YAML that is no text. `children` are all elements
    below in their order, those that are actions and those that belong to this one (`param`, `remap`, ...).
    """

    tag: str
    line: int
    attributes: Mapping[str, Attribute] = field(default_factory=dict)
    typed: frozenset[str] = frozenset()
    children: tuple[Element, ...] = ()

    def get(self, *names: str) -> str | None:
        """Return the first attribute of these names that there is; a list as YAML."""
        for name in names:
            value = self.attributes.get(name)
            if value is not None:
                return f"[{', '.join(value)}]" if isinstance(value, list) else value
        return None

    def need(self, *names: str) -> str:
        """Return an attribute that has to be there; raises `Malformed`."""
        value = self.get(*names)
        if value is None:
            raise Malformed(f"<{self.tag}> has no attribute `{names[0]}`", self.line)
        return value

    def of(self, *tags: str) -> tuple[Element, ...]:
        """Return the children of these tags."""
        return tuple(child for child in self.children if child.tag in tags)
