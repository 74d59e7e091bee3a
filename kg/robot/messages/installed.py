"""Definitions of message types in an installed ROS 2: `share/PACKAGE/{msg,srv,action}/NAME` below each prefix.

Setup files of ROS 2 list the prefixes in the variable `AMENT_PREFIX_PATH`, the first of which takes precedence.
"""

from __future__ import annotations

import os
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.robot.messages import definitions
from kg.robot.messages.definitions import Definition, is_type, parts

if TYPE_CHECKING:
    from collections.abc import Mapping

_ROS: Final = 2
_SORTS: Final = ("msg", "srv", "action")
_LONGEST: Final = 1 << 20  # bytes of a definition up to which it is read


@cache
def installed(prefixes: str) -> Installed:
    """Return the definitions below a list of prefixes, in the form of `AMENT_PREFIX_PATH`."""
    return Installed(tuple(Path(one) for one in prefixes.split(os.pathsep) if one))


class Installed:
    """The definitions of messages, read when they are needed."""

    def __init__(self, prefixes: tuple[Path, ...]) -> None:
        self._prefixes = prefixes
        self._definitions: dict[str, Mapping[str, Definition]] = {}

    def get(self, name: str) -> Definition | None:
        """Return the definition of a message, or of a part of a service or action; None if no valid one is installed.

        A package of the name `package` is the first one below the prefixes, as for ROS 2.
        """
        if not is_type(name):
            return None
        package, _, own = name.partition("/")
        whole = own.partition("_")[0]  # names of types have no underscores, except before their parts
        key = f"{package}/{whole}"
        if key not in self._definitions:
            self._definitions[key] = self._read(package, whole)
        return self._definitions[key].get(name)

    def _read(self, package: str, whole: str) -> Mapping[str, Definition]:
        shares = (prefix / "share" / package for prefix in self._prefixes)
        share = next((one for one in shares if one.is_dir()), None)
        definitions_by_name: dict[str, Definition] = {}
        if share is None:
            return definitions_by_name
        for sort in _SORTS:
            with suppress(OSError, ValueError):  # no such file, or a type that kg does not support
                with (share / sort / f"{whole}.{sort}").open(encoding="utf-8") as file:
                    text = file.read(_LONGEST)
                texts = parts(f"{package}/{whole}", sort, text, _ROS)
                definitions_by_name |= {name: definitions.read(name, part) for name, part in texts}
        return definitions_by_name
