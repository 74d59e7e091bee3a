"""Rendering of pages: shared context and template functions.

    async def start(request):
        found = await view(request, "overview")
        return page(request, "start.html", title="Start", twin="/api/overview", overview=found)

Templates escape all data; `href` creates links only to web addresses.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import urlsplit

import msgspec
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from starlette.responses import HTMLResponse

from kg.server import libraries
from kg.server.addresses import NAVIGATION, url
from kg.server.prose import breakable, inline, prose, source
from kg.server.safety.headers import policy
from kg.server.safety.tokens import is_trusted
from kg.server.state import state
from kg.server.views import answer

if TYPE_CHECKING:
    from starlette.requests import Request

_WEB: Final = {"http", "https", "vscode"}


async def view(request: Request, name: str, /, **arguments: str) -> Any:
    """Return the decoded result of the view `name`; raises as `Readers.call`."""
    return msgspec.json.decode(await answer(request, name, **arguments))


def page(
    request: Request, template: str, *, title: str, twin: str = "", status: int = 200, **context: Any
) -> HTMLResponse:
    """Return a page.

    `title` is its name, `twin` the address of the same data as JSON, and the rest is passed to the template.
    """
    server = state(request)
    import_map = libraries.import_map()
    shared = {
        "title": title,
        "twin": twin,
        "path": request.url.path,
        "navigation": tuple(NAVIGATION.items()),
        "search_text": request.query_params.get("q", "") if request.url.path == "/search" else "",
        "snapshot": server.readers.layout.current(),
        "writable": server.options.write,
        "logged_in": is_trusted(request),
        "import_map": import_map,
        "libraries": libraries.libraries(),
        "libraries_help": libraries.HELP,
    }
    text = environment().get_template(template).render(shared | context)
    headers = {"Cache-Control": "no-cache", "Content-Security-Policy": policy(libraries.source_of(import_map))}
    return HTMLResponse(text, status, headers=headers)


@cache
def environment() -> Environment:
    """Return the template environment with its functions: `url`, and filters of this module and of kg.server.prose."""
    templates = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    templates.globals["url"] = url
    templates.filters |= {"number": _number, "href": _href, "moment": _moment}
    templates.filters |= {"breakable": breakable, "inline": inline, "prose": prose, "source": source}
    return templates


def _number(value: float) -> str:
    return f"{value:,}"


def _href(address: str | None) -> str:
    """Return a web address; empty for others, such as `javascript:`."""
    return address if address and urlsplit(address).scheme in _WEB else ""


def _moment(read: str | None) -> str:
    """Format an ISO 8601 time for people, to the minute."""
    return f"{read[:10]} {read[11:16]}" if read else ""
