"""Conditional changes: the headers `If-Match` and `If-None-Match` (RFC 9110, section 13.1), and `snapshot`."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from kg.errors import QueryError
from kg.server.errors import RequestError
from kg.server.state import state

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from starlette.requests import Request

    from kg.pipeline.updating.changes import Updated
    from kg.server.parameters import Parameters

_TAG: Final = r'(W/)?"([\x21\x23-\x7e\x80-\xff]*)"'
_ELEMENT: Final = rf"[ \t]*(?:{_TAG}[ \t]*)?"
_LIST: Final = re.compile(f"(?:{_ELEMENT},)*{_ELEMENT}")
"""A list of entity tags, which may contain commas; elements may be empty (RFC 9110, section 5.6.1.2)."""
_ANY: Final = "*"
_MATCH: Final = "If-Match"
_NONE_MATCH: Final = "If-None-Match"


async def on_condition(
    request: Request,
    parameters: Parameters,
    change: Callable[[str | None], Awaitable[Updated]],
    exists: Callable[[], Awaitable[bool]] | None = None,
) -> Updated:
    """Make a change if the request has no condition, or its condition holds.

    `change` receives the identity of the only data that it may change, None for any. `exists` returns whether the
    target exists, by default true. A tag matches if it belongs to the current data, whatever was read: entity tags
    begin with the identity of the data, which may also be used alone.

    Raises:
        RequestError: KG536 the condition does not hold, KG520 it is malformed.
        KgError: as `change`; KG512 the current data is not that of `snapshot`.
    """
    named = parameters.one("snapshot")
    match, none_match = (", ".join(request.headers.getlist(name)).strip() for name in (_MATCH, _NONE_MATCH))
    if match == _ANY and exists is None:
        match = ""
    if not match and not none_match:
        return await change(named)
    current = str(state(request).readers.layout.current() or 0)

    async def matches(name: str, value: str) -> bool:
        if value == _ANY:
            return await exists() if exists else True
        return current in _snapshots(name, value)

    if match == _ANY and not await matches(_MATCH, match):
        raise RequestError("KG536", "`If-Match: *` fails: the graph does not exist", hint="Leave it out to create one.")
    if match and not await matches(_MATCH, match):
        raise RequestError("KG536", f"`If-Match` fails: the data is snapshot {current}")
    if none_match and await matches(_NONE_MATCH, none_match):
        reason = "the target exists" if none_match == _ANY else f"the data is still snapshot {current}"
        raise RequestError("KG536", f"`If-None-Match` fails: {reason}", hint="Leave it out to change what exists.")
    try:
        return await change(named or current)
    except QueryError as error:
        if error.code != "KG512" or named:
            raise
        raise RequestError("KG536", f"the condition fails: {error.message}") from error


def _snapshots(name: str, value: str) -> set[str]:
    """Return the identities of the data in a list of tags; weak tags never match where a match is required.

    Source: RFC 9110, sections 13.1.1 and 13.1.2.
    """
    tags = re.findall(_TAG, value) if _LIST.fullmatch(value) else []
    if not tags:
        raise RequestError("KG520", f"`{name}` is not a list of entity tags", hint='Send `*`, or tags such as "7".')
    return {tag.partition("-")[0] for weak, tag in tags if not weak or name == _NONE_MATCH}
