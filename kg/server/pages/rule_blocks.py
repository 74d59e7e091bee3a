"""`/rule-blocks`: the page on which rules are composed of blocks; the views that its script asks do the rest.

`name` opens a rule at hand. A rule of a shared link stands behind the `#`, which the server does not see.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.routing import Route

from kg.server.addresses import url
from kg.server.rendering import page

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response


async def _rule_blocks(request: Request) -> Response:
    name = request.query_params.get("name", "")
    return page(request, "rule_blocks.html", title="Rule made of blocks", twin=url("/api/blocks"), rule=name)


ROUTES = [Route("/rule-blocks", _rule_blocks)]
