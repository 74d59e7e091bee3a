"""The pages: one module each, with its `ROUTES`; templates stand in `kg/server/templates`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.server.pages import channel, lists, node, query, resource, robot, rules, search, start, system, why

if TYPE_CHECKING:
    from starlette.routing import BaseRoute

__all__ = ["ROUTES"]

ROUTES: Final[list[BaseRoute]] = [
    *start.ROUTES,
    *search.ROUTES,
    *lists.ROUTES,
    *node.ROUTES,
    *system.ROUTES,
    *channel.ROUTES,
    *resource.ROUTES,
    *rules.ROUTES,
    *query.ROUTES,
    *robot.ROUTES,
    *why.ROUTES,
]
"""The routes of all pages."""
