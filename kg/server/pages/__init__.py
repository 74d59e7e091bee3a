"""The pages: modules with `ROUTES` of one page or two related ones; templates are in `kg/server/templates`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.server.pages import lists, node, query, resource, robot, rules, search, system, why

if TYPE_CHECKING:
    from starlette.routing import BaseRoute

__all__ = ["ROUTES"]

ROUTES: Final[list[BaseRoute]] = [
    *search.ROUTES,
    *lists.ROUTES,
    *node.ROUTES,
    *resource.ROUTES,
    *system.ROUTES,
    *rules.ROUTES,
    *query.ROUTES,
    *robot.ROUTES,
    *why.ROUTES,
]
"""The routes of all pages."""
