"""Stable, readable IRIs for everything in the graph.

An IRI is `<base><kind>/<part>/<part>...`. Parts are percent-encoded (RFC 3986), so that any text makes a valid
IRI, different things get different IRIs, and `Iris.parse` gets the parts back. A part that is a path keeps its
slashes; a kind has at most one of these, or two with the segment `-` between them. What has no meaning without
its owner (an interface of a node, a field of a definition) is a fragment of the owner's IRI.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Final
from urllib.parse import quote, unquote, urlsplit

from kg.errors import UsageError

DEFAULT_BASE: Final = "https://w3id.org/rnkg/"
"""The base of all IRIs unless a setting says otherwise."""

_UNKNOWN: Final = "@unresolved"
"""Stands in a fragment for a name that is not known; `@` never occurs in an encoded name."""

RUNNING: Final = "robot"
"""Placeholder for the source and the package of observed systems; names of sources contain a slash."""

_BETWEEN: Final = "-"
_SOURCE_GRAPHS: Final = "graph/source/"
_SHAPES: Final[dict[str, str]] = {
    "repository": "p",
    "package": "ps",
    "node": "pss",
    "executable": "pss",
    "definition": "psss",
    "file": "p-p",
    "configuration": "p-p",
    "start": "p-p",
    "build": "ps",
    "topic": "p",
    "service": "p",
    "action": "p",
    "message": "p",
    "service-type": "p",
    "action-type": "p",
    "package-name": "s",
    "phrase": "s",
    "person": "ps",
    "qos": "ssss*",
    "software": "ss",
}
"""For each kind its parts in order: `p` a path, `s` one segment, `-` the segment between two paths, `*` any more."""


@dataclass(frozen=True, slots=True)
class Thing:
    """A parsed IRI: its kind and its decoded parts."""

    kind: str
    parts: tuple[str, ...]


def is_source_graph(iri: str) -> bool:
    """Return whether an IRI, with any base, is that of the named graph of a source."""
    return f"/{_SOURCE_GRAPHS}" in iri


@lru_cache(maxsize=1 << 14)
def _segment(text: str) -> str:
    encoded = quote(text, safe=":", errors="surrogatepass")
    return encoded.replace(".", "%2E") if encoded in {".", ".."} else encoded


@lru_cache(maxsize=1 << 14)
def _path(text: str) -> str:
    return "/".join(map(_segment, text.split("/")))


def _placed(repository: str, path: str) -> str:
    segments = ("%2D" if part == _BETWEEN else _segment(part) for part in repository.split("/"))
    return f"{'/'.join(segments)}/{_BETWEEN}/{_path(path)}"


def _decode(text: str) -> str:
    return unquote(text, errors="surrogatepass")


def fragment(owner: str, kind: str, name: str | None, count: int = 1) -> str:
    """Return the IRI of the `count`-th part of `owner` (an IRI) that has this `kind` and `name` (None: not known)."""
    number = f"@{count}" if count > 1 else ""
    mark = "/" if "#" in owner else "#"
    return f"{owner}{mark}{_segment(kind)}/{_UNKNOWN if name is None else _path(name)}{number}"


@dataclass(frozen=True, slots=True)
class Iris:
    """Makes the IRIs below `base`, which is absolute and ends in `/` (`UsageError` KG002 otherwise)."""

    base: str = DEFAULT_BASE

    def __post_init__(self) -> None:
        parts = urlsplit(self.base)
        plain = quote(self.base, safe=":/?#[]@!$&'()*+,;=%~") == self.base
        if not (parts.scheme and parts.netloc and self.base.endswith("/") and plain and "#" not in self.base):
            message = f"the base of IRIs must be an absolute IRI that ends in a slash, not {self.base!r}"
            raise UsageError("KG002", message, hint=f"the default is {DEFAULT_BASE}")

    def repository(self, repository: str) -> str:
        """Return the IRI of a source, `host/owner/name` or `local/NAME`."""
        return f"{self.base}repository/{_path(repository)}"

    def package(self, repository: str, package: str) -> str:
        """Return the IRI of a package of a source."""
        return f"{self.base}package/{_path(repository)}/{_segment(package)}"

    def node(self, repository: str, package: str, node: str) -> str:
        """Return the IRI of a node type of a package."""
        return f"{self.base}node/{_path(repository)}/{_segment(package)}/{_segment(node)}"

    def executable(self, repository: str, package: str, name: str) -> str:
        """Return the IRI of what `rosrun package name` starts."""
        return f"{self.base}executable/{_path(repository)}/{_segment(package)}/{_segment(name)}"

    def definition(self, repository: str, package: str, kind: str, name: str) -> str:
        """Return the IRI of a msg, srv or action file's content as this source has it."""
        return f"{self.base}definition/{_path(repository)}/{_segment(package)}/{_segment(kind)}/{_segment(name)}"

    def file(self, repository: str, path: str) -> str:
        """Return the IRI of a file of a source; `path` is relative to the root of the source."""
        return f"{self.base}file/{_placed(repository, path)}"

    def configuration(self, repository: str, path: str) -> str:
        """Return the IRI of what the launch file at `path` of a source starts."""
        return f"{self.base}configuration/{_placed(repository, path)}"

    def start(self, repository: str, digest: str) -> str:
        """Return the IRI of what launch files of a source start nodes with, by the digest of it."""
        return f"{self.base}start/{_placed(repository, digest)}"

    def build(self, repository: str, started: str) -> str:
        """Return the IRI of the reading of a source that began at `started` (ISO 8601)."""
        return f"{self.base}build/{_path(repository)}/{_segment(started)}"

    def channel(self, kind: str, name: str) -> str:
        """Return the IRI of a `topic`, `service` or `action`; `name` is absolute."""
        return f"{self.base}{kind}/{_path(name.removeprefix('/'))}"

    def interface_type(self, kind: str, name: str) -> str:
        """Return the IRI of a `message`, `service-type` or `action-type`; `name` is `package/Type`."""
        return f"{self.base}{kind}/{_path(name)}"

    def package_name(self, name: str) -> str:
        """Return the IRI of a package name, whatever source has a package of that name."""
        return f"{self.base}package-name/{_segment(name)}"

    def phrase(self, text: str) -> str:
        """Return the IRI of a noun phrase, its words in lower case."""
        return f"{self.base}phrase/{_segment(text)}"

    def person(self, place: str, name: str) -> str:
        """Return the IRI of a person; `place` is an e-mail address or, without one, the source that names them."""
        return f"{self.base}person/{_path(place)}/{_segment(name)}"

    def qos(self, *policies: str) -> str:
        """Return the IRI of a combination of reliability, durability, history and depth, `-` for one not known.

        Rarer policies that are set follow as `deadline:0.1`, `lifespan:`, `liveliness:` and `lease:`, in this order.
        """
        return f"{self.base}qos/{'/'.join(map(_segment, policies))}"

    def software(self, name: str, version: str) -> str:
        """Return the IRI of a version of a program."""
        return f"{self.base}software/{_segment(name)}/{_segment(version)}"

    def graph(self, name: str) -> str:
        """Return the IRI of a named graph: `ontology`, `inferred`, `builds`, `starts`, ...."""
        return f"{self.base}graph/{_segment(name)}"

    def source_graph(self, repository: str) -> str:
        """Return the IRI of the named graph of a source."""
        return f"{self.base}{_SOURCE_GRAPHS}{_path(repository)}"

    def launch_graph(self, repository: str, path: str) -> str:
        """Return the IRI of the named graph of what one launch file starts."""
        return f"{self.base}graph/launch/{_placed(repository, path)}"

    def robot_graph(self, name: str) -> str:
        """Return the IRI of the named graph of a running system."""
        return f"{self.base}graph/robot/{_path(name)}"

    def system_graph(self, repository: str, path: str) -> str:
        """Return the IRI of the named graph of a launch configuration, or of a running system (`RUNNING`)."""
        return self.robot_graph(path) if repository == RUNNING else self.launch_graph(repository, path)

    def parse(self, iri: str) -> Thing | None:
        """Return what `iri` (without fragment) was made of; None when it is none of the kinds of this base."""
        kind, _, tail = iri.removeprefix(self.base).partition("/")
        shape = _SHAPES.get(kind)
        if shape is None or not iri.startswith(self.base) or "#" in iri:
            return None
        segments = tail.split("/")
        parts = _split_paths(segments) if shape == "p-p" else _split(segments, shape)
        if parts is None:
            return None
        if kind in {"topic", "service", "action"}:
            parts = ("/" + parts[0],)
        return Thing(kind, parts)


def _split_paths(segments: list[str]) -> tuple[str, ...] | None:
    if _BETWEEN not in segments:
        return None
    at = segments.index(_BETWEEN)
    return "/".join(map(_decode, segments[:at])), "/".join(map(_decode, segments[at + 1 :]))


def _split(segments: list[str], shape: str) -> tuple[str, ...] | None:
    if shape.endswith("*"):
        shape = shape[:-1] + "s" * (len(segments) - len(shape) + 1)
    tail = len(shape) - 1 if shape[0] == "p" else len(shape)
    if len(segments) < len(shape) or (shape[0] == "s" and len(segments) != tail):
        return None
    head = segments[: len(segments) - tail]
    last = tuple(map(_decode, segments[len(segments) - tail :]))
    return ("/".join(map(_decode, head)), *last) if shape[0] == "p" else last
