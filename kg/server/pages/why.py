"""`/why?subject=&predicate=&object=`: the proof of a fact; `/why?query=&row=`: the proof of a row of a result.

`row` is a JSON object from variables to terms in N-Triples. Queries may be too long for an address, so the parameters
may also be a posted form.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.routing import Route

from kg.errors import KgError, RuleError, UsageError
from kg.server.addresses import url
from kg.server.errors import STATUS
from kg.server.pages.missing import missing
from kg.server.parameters import FORM, Parameters, media_type
from kg.server.rendering import page, view
from kg.server.safety.bodies import ADDRESS_BYTES

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response


async def _why(request: Request) -> Response:
    form = await request.body() if media_type(request) == FORM else b""
    given = Parameters(request.scope["query_string"], form)
    if "query" in given:
        return await _of_row(request, query=given.one("query") or "", row=given.one("row") or "{}")
    fact = {key: given.one(key) or "" for key in ("subject", "predicate", "object")}
    return await _of_fact(request, fact, given.one("every") or "")


async def _of_fact(request: Request, fact: dict[str, str], every: str) -> Response:
    if not all(fact.values()):
        hint = "For example `/why?subject=patrol&predicate=subscribes&object=scan_filtered`."
        raise UsageError("KG003", "a fact is a subject, a predicate and an object", hint=hint)
    try:
        why = await view(request, "why", **fact, every=every)
    except KgError as error:
        if error.code == "KG226":
            lacking = await view(request, "why_not", **fact)
            title, twin = f"Why not: {lacking['fact']['text']}", url("/api/why_not", **fact)
            return page(request, "why.html", title=title, twin=twin, every="", why=None, lacking=lacking)
        return missing(request, error, "Why", fact["subject"], lambda other: url("/search", q=other))
    return page(
        request,
        "why.html",
        title=f"Why: {why['proofs'][0]['text']}",
        twin=url("/api/why", **fact, every=every),
        every="" if every else url("/why", **fact, every="all"),
        why=why,
        lacking=None,
    )


async def _of_row(request: Request, **arguments: str) -> Response:
    """Return the page about a row; if it cannot be traced back to facts, with the reason and its status."""
    traced, problem = None, None
    try:
        traced = await view(request, "why_row", **arguments)
    except RuleError as error:
        problem = error
    return page(
        request,
        "why_row.html",
        title="Why this row",
        status=STATUS.get(problem.code, 400) if problem else 200,
        twin=url("/api/why_row", **arguments),
        found=traced,
        problem=problem,
        query=address if len(address := url("/query", query=arguments["query"])) < ADDRESS_BYTES else "",
    )


ROUTES = [Route("/why", _why, methods=["GET", "POST"])]
