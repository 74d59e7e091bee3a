"""Tests of the OpenAPI description of the server, and a short fuzzing of its operations."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING, Any

from patience import patient
from repository import ROOT
from starlette.routing import Route

from kg.server.openapi import OPERATIONS
from kg.views.calls import CALLS

if TYPE_CHECKING:
    from pathlib import Path

    from starlette.testclient import TestClient

ROUNDS = 6
"""Batches of 25 requests; `benchmarks/fuzzing` runs for ten minutes."""


def test_every_route_is_described(client: TestClient) -> None:
    """Each address and method of the server is described, and each view with its parameters."""
    app: Any = client.app
    paths = client.get("/openapi.json").json()["paths"]
    for route in app.routes:
        if isinstance(route, Route) and (route.path == "/" or not route.path.endswith("/")) and "api" not in route.path:
            path = route.path.replace(":path}", "}")
            methods = {"x-query" if method == "QUERY" else method.lower() for method in route.methods or ()}
            assert methods - {"head", "options"} == set(paths[path]), route.path
    assert {f"/api/{name}" for name in CALLS} <= set(paths)
    assert {parameter["name"] for parameter in paths["/api/rule"]["get"]["parameters"]} == {"name"}


def test_what_is_described_is_there(client: TestClient) -> None:
    """Every described address and parameter exists on the server."""
    paths = client.get("/openapi.json").json()["paths"]
    for method, path in OPERATIONS:
        assert ("x-query" if method == "QUERY" else method.lower()) in paths[path], path


def test_what_a_form_of_the_description_says(client: TestClient) -> None:
    """Errors are described once, changes need the token, and each operation has a summary."""
    document = client.get("/openapi.json").json()
    assert document["openapi"] == "3.1.0"
    assert document["paths"]["/update"]["post"]["security"] == [{"token": []}]
    for operations in document["paths"].values():
        for operation in operations.values():
            assert operation["summary"]
            assert operation["responses"]["default"] == {"$ref": "#/components/responses/Problem"}


def test_nothing_asked_at_random_is_a_defect(store: Path) -> None:
    """Hundreds of random requests cause no 500, no unparsable body and no crash."""
    command = [sys.executable, str(ROOT / "benchmarks" / "fuzzing"), str(store), "--rounds", str(ROUNDS), "--write"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=patient(60), check=False)
    assert done.returncode == 0, done.stdout + done.stderr
