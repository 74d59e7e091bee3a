"""`/rules`, `/rules?family=&q=`, `/rule?name=`: families of rules, rules of a family or with words, and one rule.

`/rule-blocks` is the editor that composes rules from blocks.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from starlette.responses import RedirectResponse, Response
from starlette.routing import Route

from kg.errors import KgError
from kg.server.addresses import url
from kg.server.pages.missing import missing
from kg.server.rendering import page, view

if TYPE_CHECKING:
    from starlette.requests import Request

_SEE_OTHER: Final = 303


async def _rules(request: Request) -> Response:
    family, text = request.query_params.get("family", ""), request.query_params.get("q", "").strip()
    chosen = {key: value for key, value in (("family", family), ("text", text)) if value}
    try:
        rules = await view(request, "rule_index", **chosen)
    except KgError as error:
        return missing(
            request, error, f"Rules of {family}", family, lambda other: url("/rules", family=other), several=False
        )
    title = f"Rules of {family}" if family else "Rules"
    twin = url("/api/rule_index", **chosen)
    return page(request, "rules.html", title=title, twin=twin, rules=rules, family=family, text=text)


async def _rule(request: Request) -> Response:
    name = request.query_params.get("name", "")
    if not name:
        return RedirectResponse(url("/rules"), _SEE_OTHER)
    try:
        rule = await view(request, "rule", name=name)
    except KgError as error:
        return missing(request, error, f"Rule {name}", name, lambda other: url("/rule", name=other), several=False)
    return page(request, "rule.html", title=f"Rule {rule['rule']}", twin=url("/api/rule", name=rule["rule"]), rule=rule)


async def _rule_blocks(request: Request) -> Response:
    # The script requests the rest from views; a shared rule is in the fragment, which the server never sees.
    name = request.query_params.get("name", "")
    return page(request, "rule_blocks.html", title="Rule made of blocks", twin=url("/api/blocks"), rule=name)


ROUTES = [Route("/rules", _rules), Route("/rule", _rule), Route("/rule-blocks", _rule_blocks)]
