"""The page for an unknown or ambiguous name, with suggestions."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from kg.server.addresses import url
from kg.server.rendering import page

if TYPE_CHECKING:
    from collections.abc import Callable

    from starlette.requests import Request
    from starlette.responses import Response

    from kg.errors import KgError

_ABSENT: Final = frozenset({"KG001", "KG226", "KG422"})  # codes of errors about missing things
_SEVERAL: Final = "KG003"
_NAMED: Final = re.compile(r"`(?:kg node )?([^`]+)`(?:  \(([^)\n]*)\))?")
_NOT_FOUND: Final = 404
_CHOICES: Final = 300


def missing(  # noqa: PLR0913 - what the page shows
    request: Request, error: KgError, title: str, text: str, address: Callable[[str], str], *, several: bool = True
) -> Response:
    """Return the page for an error about a name: 404 if it is unknown, 300 if it is ambiguous; raise other errors.

    `text` is offered for a search; `address` returns the address of the page of a suggested name. `several` is whether
    names can be ambiguous.
    """
    is_several = several and error.code == _SEVERAL
    if error.code not in _ABSENT and not is_several:
        raise error
    named = [(name, about, address(name)) for name, about in _NAMED.findall(error.hint or "")]
    return page(
        request,
        "missing.html",
        title=title,
        status=_CHOICES if is_several else _NOT_FOUND,
        problem=error,
        named=[one for one in named if not one[0].startswith(("/search", "kg "))],
        several=is_several,
        search=url("/search", q=text),
        text=text,
    )
