"""The routes of whoever runs the server: health, metrics, logging in, what a code means."""

from __future__ import annotations

from typing import Final

from kg.server import errors, health, metrics, openapi
from kg.server.safety import login

ROUTES: Final = [*health.ROUTES, *metrics.ROUTES, *openapi.ROUTES, *login.ROUTES, *errors.ROUTES]
"""All of them."""
