"""A command line that does not fit the commands becomes an error like all others, with the nearest name that does."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

from kg.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from typer.exceptions import TyperException

__all__ = ["as_usage_error", "did_you_mean"]


def did_you_mean(name: str, names: Iterable[str], *, most: int = 3) -> str | None:
    """Return "did you mean `a` or `b`?" for names near `name`, None when there are none."""
    known = {one.lower(): one for one in names}
    close = get_close_matches(name.lower(), known, n=most, cutoff=0.6)
    holding = sorted((one for one in known if len(name) > 2 and name.lower() in one), key=len)  # noqa: PLR2004 - shorter parts are in everything
    found = list(dict.fromkeys((*close, *holding)))[:most]
    return _question([known[one] for one in found]) if found else None


def _question(names: list[str]) -> str:
    *first, last = [f"`{name}`" for name in names]
    return f"did you mean {' or '.join(filter(None, (', '.join(first), last)))}?"


def as_usage_error(error: TyperException) -> UsageError:
    """Return KG003 for what typer has to say about the arguments."""
    context: Any = getattr(error, "ctx", None)
    see = f"see `{context.command_path} --help`" if context else "see `kg --help`"
    message = error.message if hasattr(error, "option_name") else error.format_message()
    near = getattr(error, "possibilities", None)
    hint = _question(sorted(near)) if near else None
    return UsageError("KG003", _lower(" ".join(message.split()).rstrip(".")), hint="\n".join(filter(None, (hint, see))))


def _lower(sentence: str) -> str:
    return sentence[:1].lower() + sentence[1:]
