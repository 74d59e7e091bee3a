"""W3C cases that are exchanges over HTTP (protocol, graph store protocol), played against any endpoint.

    play(case, Endpoint("127.0.0.1", 7878))

Each exchange of a case is a request with the expected response; AssertionError names the failing one.
"""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass, field
from http.client import HTTPConnection
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import pyoxigraph
from patience import patient
from pyoxigraph import QueryResultsFormat, RdfFormat
from w3c import MF, same_graphs, solutions

if TYPE_CHECKING:
    from collections.abc import Mapping

    from w3c import Case

    from kg.store.layout import Layout

__all__ = ["Answer", "Endpoint", "Standard", "play", "prepare"]

_HT: Final = "http://www.w3.org/2011/http#"
_STATUSES: Final = "http://www.w3.org/2011/http-statusCodes#"
_CNT: Final = "http://www.w3.org/2011/content#"
_NAMED_STATUSES: Final = {"OK": 200, "Created": 201, "NoContent": 204, "NotFound": 404}
_TYPES: Final = {
    "boolean": {"application/sparql-results+xml", "application/sparql-results+json"},
    "tabular": {
        "application/sparql-results+xml",
        "application/sparql-results+json",
        "text/csv",
        "text/tab-separated-values",
    },
    "RDF": {"application/rdf+xml", "text/turtle", "application/n-triples", "application/n-quads"},
}


@dataclass(frozen=True, slots=True)
class Answer:
    """The response to one request; header names are in lower case."""

    status: int
    headers: Mapping[str, str]
    body: bytes

    @property
    def media_type(self) -> str:
        """The type of the body without parameters."""
        return self.headers.get("content-type", "").partition(";")[0]


@dataclass(frozen=True, slots=True)
class Endpoint:
    """A server with the paths of its services; `headers` go with each request."""

    host: str
    port: int
    query: str = "/sparql"
    update: str = "/update"
    store: str = "/store"
    headers: Mapping[str, str] = field(default_factory=dict)

    def send(self, method: str, path: str, body: bytes | None = None, **headers: str) -> Answer:
        """Send a request and return the response; `_` in header names means `-`."""
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        with closing(HTTPConnection(self.host, self.port, timeout=patient(60))) as connection:
            connection.request(method, path, body, {**self.headers, **named})
            answer = connection.getresponse()
            found = {name.lower(): value for name, value in answer.getheaders()}
            return Answer(answer.status, found, answer.read())


class Standard(NamedTuple):
    """A server whose default graph is the unnamed one, and its store."""

    endpoint: Endpoint
    layout: Layout


def prepare(case: Case) -> dict[str, Any]:
    """Return the named graphs of a protocol case before it starts."""
    graphs = case.manifest.all(case.node, "http://www.w3.org/2009/sparql/tests/test-update#graphData")
    label = "http://www.w3.org/2000/01/rdf-schema#label"
    graph = "http://www.w3.org/2009/sparql/tests/test-update#graph"
    return {case.manifest.text(one, label): case.manifest.one(one, graph) for one in graphs}


def play(case: Case, endpoint: Endpoint) -> None:
    """Send the requests of a case in order, and check each response."""
    manifest = case.manifest
    location = ""
    for number, request in enumerate(manifest.items(manifest.one(case.action, _HT + "requests"))):
        response = manifest.one(request, _HT + "resp")
        path = _path(case, request, endpoint).replace("$LOCATION$", location)
        method = manifest.text(request, _HT + "methodName")
        answer = endpoint.send(method, path, _body(case, request), **_headers(case, request))
        said = f"request {number + 1}: {method} {path} was answered {answer.status}: {answer.body[:300]!r}"
        _check_status(case, response, answer, said)
        _check_format(case, response, answer, said)
        _check_headers(case, response, answer, said)
        if manifest.one(response, _HT + "body") is not None:
            expected = manifest.text(manifest.one(response, _HT + "body"), _CNT + "chars").encode()
            assert same_graphs(_parse(expected), _parse(answer.body)), said
        if manifest.one(response, MF + "expectedLocation") is not None:
            location = answer.headers.get("location", "")
            assert location, said


def _parse(turtle: bytes) -> list[Any]:
    return [quad.triple for quad in pyoxigraph.parse(turtle, RdfFormat.TURTLE)]


def _headers(case: Case, node: Any) -> dict[str, str]:
    manifest = case.manifest
    listed = manifest.items(manifest.one(node, _HT + "headers"))
    return {manifest.text(one, _HT + "fieldName"): manifest.text(one, _HT + "fieldValue") for one in listed}


def _body(case: Case, request: Any) -> bytes | None:
    body = case.manifest.one(request, _HT + "body")
    if body is None:
        return None
    encoding = case.manifest.text(body, _CNT + "characterEncoding") or "UTF-8"
    return case.manifest.text(body, _CNT + "chars").encode(encoding)


def _path(case: Case, request: Any, endpoint: Endpoint) -> str:
    """Return the path of a request: the manifests leave the paths of the services open."""
    path = case.manifest.text(request, _HT + "absolutePath")
    if path.startswith("/gsp"):
        return endpoint.store + path.removeprefix("/gsp")
    kind = _headers(case, request).get("content-type", "")
    method = case.manifest.text(request, _HT + "methodName")
    updates = method == "POST" and "update" in case.identity.rpartition("#")[2] and "sparql-query" not in kind
    return (endpoint.update if updates else endpoint.query) + path.removeprefix("/sparql/")


def _check_status(case: Case, response: Any, answer: Answer, said: str) -> None:
    allowed: set[int] = set()
    for one in case.manifest.all(response, MF + "expectedStatus"):
        name = one.value.removeprefix(_STATUSES)
        family = name.removeprefix("StatusCode")
        allowed |= (
            {_NAMED_STATUSES[name]} if family == name else set(range(int(family[0]) * 100, int(family[0]) * 100 + 100))
        )
    assert answer.status in allowed, said


def _check_format(case: Case, response: Any, answer: Answer, said: str) -> None:
    expected = case.manifest.text(response, MF + "expectedFormat")
    assert not expected or answer.media_type in _TYPES[expected], f"{said} ({answer.media_type})"
    boolean = case.manifest.one(response, MF + "expectedBoolean")
    if boolean is not None:
        results_format = QueryResultsFormat.from_media_type(answer.media_type)
        assert results_format is not None, said
        assert solutions(answer.body, results_format).boolean == (boolean.value == "true"), said


def _check_headers(case: Case, response: Any, answer: Answer, said: str) -> None:
    for name, value in _headers(case, response).items():
        found = answer.headers.get(name.lower(), "")
        # The charset is optional; Turtle is in UTF-8 either way.
        assert found.lower().partition(";")[0] == value.lower().partition(";")[0], f"{said} ({name}: {found})"
