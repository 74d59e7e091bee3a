"""A command line that does not fit the commands becomes an error like all others, with the nearest name that does."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kg.errors import UsageError
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from typer.exceptions import TyperException


def as_usage_error(error: TyperException) -> UsageError:
    """Return KG003 for what typer has to say about the arguments."""
    context: Any = getattr(error, "ctx", None)
    see = f"See `{context.command_path} --help`." if context else "See `kg --help`."
    message = error.message if hasattr(error, "option_name") else error.format_message()
    near = getattr(error, "possibilities", None)
    hint = did_you_mean(getattr(error, "option_name", ""), near) if near else None
    return UsageError("KG003", _lower(" ".join(message.split()).rstrip(".")), hint="\n".join(filter(None, (hint, see))))


def _lower(sentence: str) -> str:
    return sentence[:1].lower() + sentence[1:]
