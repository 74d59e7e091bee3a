"""Addresses of recordings: `bag://FILE`, with options behind a question mark."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final
from urllib.parse import parse_qsl, unquote

from kg.errors import RobotError

__all__ = ["BagAddress"]

_OPTIONS: Final = {"speed": "as a multiple of the recorded one", "start": "seconds from the beginning"}


@dataclass(frozen=True, slots=True)
class BagAddress:
    """An address that was read: the file or folder, how fast it is played (1: as recorded), from which second on."""

    text: str
    path: Path
    speed: float = 1.0
    start: float = 0.0

    @classmethod
    def read(cls, text: str) -> BagAddress:
        """Return what an address says; RobotError KG801 for an option or a value that there is not."""
        place, _, query = text.removeprefix("bag://").partition("?")
        options = dict(parse_qsl(query, keep_blank_values=True))
        if unknown := set(options) - set(_OPTIONS):
            known = ", ".join(f"{name}= ({what})" for name, what in _OPTIONS.items())
            raise RobotError("KG801", f"`{text}` has an option `{min(unknown)}`", hint=f"Valid: {known}.")
        if not place:
            raise RobotError("KG801", f"`{text}` names no file", hint="Write bag://FILE, as in bag://drive.mcap.")
        speed, start = (_number(text, options, name, given) for name, given in (("speed", 1.0), ("start", 0.0)))
        if speed == 0:
            raise RobotError("KG801", f"`{text}`: the speed is 0", hint="Write speed=2 or speed=0.5.")
        return cls(text, Path(unquote(place)).expanduser(), speed, start)


def _number(address: str, options: dict[str, str], name: str, otherwise: float) -> float:
    text = options.get(name, str(otherwise))
    if not text.replace(".", "", 1).isdecimal() or not text.isascii():
        raise RobotError("KG801", f"`{address}`: `{text}` is not a number", hint=f"{name} is {_OPTIONS[name]}.")
    return float(text)
