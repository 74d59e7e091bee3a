"""The options of `kg serve`: texts in, what the server takes out."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from kg.cli.numbers import seconds, size, whole
from kg.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kg.server.options import Options
    from kg.settings import Settings

__all__ = ["announce", "options"]

_LOGS: Final = ("text", "json", "off")


def options(given: Mapping[str, str | None], **read: Any) -> Options:
    """Return the options of a server; UsageError KG003 for what is no number in its bounds, KG002 for another log.

    `given` has the texts of options by their names, `read` fields of `Options` that need no reading. The token comes
    from `$KG_TOKEN`.
    """
    from kg.server.options import Options  # noqa: PLC0415 - start-up time

    for name, text in given.items():
        if text is not None:
            field, reader = _READERS[name]
            read[field] = reader(text, "--" + name.replace("_", "-"))
    return Options(token=os.environ.get("KG_TOKEN") or None, **read)


def announce(address: str, settings: Settings, options: Options, *, say: Callable[[str], None], browse: bool) -> None:
    """Say where the server listens, what of, and to whom; with `browse` open its start page."""
    from kg.server.libraries import HELP, libraries  # noqa: PLC0415 - start-up time
    from kg.store.opening import layout_of  # noqa: PLC0415 - start-up time

    data = "union of all graphs" if options.union else "unnamed graph"
    say(f"serving {layout_of(settings).root} at {address}")
    say(f"SPARQL at {address}sparql (default graph: {data}), graphs at {address}store")
    say("changes: from clients with the token" if options.write else "changes: none; `--write` allows them")
    if options.robot:
        who = (
            "by clients with the token"
            if options.token or options.token_file
            else "by nobody; set KG_TOKEN to allow it"
        )
        say(f"robot {options.robot} at {address}robot (moved {who})")
    if not libraries():
        say(f"pages have no pictures and a plain editor: their libraries are not installed. {HELP}")
    if browse:
        import webbrowser  # noqa: PLC0415 - with the branch that needs it

        webbrowser.open(address)


def _from(least: int, most: int | None = None) -> Callable[[str, str], int]:
    return lambda text, option: whole(text, option, least, most)


def _log(text: str, option: str) -> str:
    if text not in _LOGS:
        raise UsageError("KG002", f"`{option} {text}` is not one of {', '.join(_LOGS)}")
    return text


def _path(text: str, _option: str) -> Path:
    return Path(text).expanduser()


_READERS: Final[Mapping[str, tuple[str, Callable[[str, str], Any]]]] = {
    "port": ("port", _from(0, 65535)),
    "token_file": ("token_file", _path),
    "readers": ("readers", _from(1, 256)),
    "queue": ("queue", _from(0, 100_000)),
    "timeout": ("seconds", seconds),
    "update_timeout": ("update_seconds", seconds),
    "max_rows": ("rows", _from(1)),
    "max_answer_bytes": ("answer_bytes", size),
    "max_body_bytes": ("body", size),
    "max_memory": ("memory", size),
    "cache": ("cache", size),
    "grace": ("grace", seconds),
    "log": ("log", _log),
    "slow": ("slow", seconds),
    "slow_log": ("slow_log", _path),
}
"""Name of an option to the field of `Options` that it sets, and what reads its text."""
