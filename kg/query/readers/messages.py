"""What is said between a reader and the process that started it.

A message is a frame: its length (four bytes, big-endian), its kind (one byte), then MessagePack, or plain bytes for a
part of an answer. For each request a reader says `Head`, any number of parts and `Progress`, then `End`; or `Failure`
at any moment.
"""

from __future__ import annotations

import struct
from typing import Any, Final, TypeAlias

import msgspec

from kg.errors import KgError, Place, QueryError

PREFIX: Final = struct.Struct(">IB")
"""The length of what follows, and its kind."""

_MESSAGE: Final = 0
_PART: Final = 1


class Configuration(msgspec.Struct, frozen=True, tag="configuration"):
    """The first message to a reader: `root` is the folder of the store, `memory` how many bytes a request may use.

    `address` is that of the server that has the data, None for a store of this machine.

    `calls` names the module whose `CALLS` other requests are looked up in, by `Call.name`; `settings` are flags for
    `kg.settings.load`, which these are given.
    """

    root: str
    memory: int | None = None
    calls: str = ""
    settings: dict[str, Any] = {}
    address: str | None = None


class Question(msgspec.Struct, frozen=True, tag="question", kw_only=True):
    """A SPARQL query.

    `formats` names the format to answer in for each kind of answer that is acceptable (`rows`, `boolean`, `graph`; see
    `kg.query.formats`). `parameters` are terms for variables, as N-Triples writes them. `default_graphs` and
    `named_graphs` replace the data set that the query names (SPARQL 1.1 Protocol, section 2.1.4); without them the
    default graph is the union of all graphs, or with `union` false the unnamed one. `rows` caps rows or triples,
    the first `offset` are left out; `size` caps the bytes of the answer (KG511). `snapshot` asks for the data of that
    identity and no other (KG512). `path` is what errors name as the place of the text, `base` what its relative IRIs
    are relative to; without one they are errors.
    """

    text: str
    formats: dict[str, str]
    parameters: dict[str, str] = {}
    default_graphs: tuple[str, ...] | None = None
    named_graphs: tuple[str, ...] | None = None
    union: bool = True
    rows: int | None = None
    offset: int = 0
    snapshot: str | None = None
    path: str = "query"
    base: str | None = None
    size: int | None = None


class Call(msgspec.Struct, frozen=True, tag="call"):
    """A request for one of the functions of `Configuration.calls`, which answers in JSON."""

    name: str
    arguments: dict[str, Any] = {}


class Ready(msgspec.Struct, frozen=True, tag="ready"):
    """From a reader, once: it has opened what is in force, or tried, and waits for requests as the process `pid`."""

    pid: int


class Refresh(msgspec.Struct, frozen=True, tag="refresh"):
    """To a reader with nothing to do: the data may have changed, let go of what is no longer in force."""


class Head(msgspec.Struct, frozen=True, tag="head"):
    """The beginning of an answer: `kind` is `rows`, `boolean`, `graph` or `json`, `format` what it is written in.

    `snapshot` is the identity of the data. `repeatable` tells whether the same request to the same data has the same
    answer, which those with NOW or RAND have not; of a view it is not known, and said to be false.
    """

    kind: str
    format: str
    snapshot: str
    variables: tuple[str, ...] = ()
    repeatable: bool = True


class Progress(msgspec.Struct, frozen=True, tag="progress"):
    """How many rows or triples were found so far; said ten times a second while there are more and more."""

    rows: int


class End(msgspec.Struct, frozen=True, tag="end"):
    """The end of an answer that is whole; `more` tells that the cap of rows cut it.

    `last` tells that the reader has grown large, or that something goes on in it: it is to answer nothing else.
    """

    rows: int
    seconds: float
    more: bool = False
    last: bool = False


class Failure(msgspec.Struct, frozen=True, tag="failure"):
    """An error of `kg`, as one of its own or one of the engine's; what was said of the answer before is void.

    `last` is that of `End`.
    """

    code: str
    message: str
    kind: str = "QueryError"
    hint: str | None = None
    path: str | None = None
    line: int | None = None
    column: int | None = None
    excerpt: str | None = None
    end_line: int | None = None
    end_column: int | None = None
    last: bool = False

    @classmethod
    def of(cls, error: KgError) -> Failure:
        """Return what tells an error to another process."""
        place = error.place
        told = tuple(getattr(place, name) for name in Place.__dataclass_fields__) if place else ()
        return cls(error.code, error.message, type(error).__name__, error.hint, *told)

    def error(self) -> KgError:
        """Return the error that was told."""
        place = None
        if self.path is not None:
            place = Place(self.path, self.line, self.column, self.excerpt, self.end_line, self.end_column)
        known = {kind.__name__: kind for kind in _subclasses(KgError)}
        return known.get(self.kind, QueryError)(self.code, self.message, place=place, hint=self.hint)


Message: TypeAlias = Configuration | Question | Call | Ready | Refresh | Head | Progress | End | Failure

_ENCODER: Final = msgspec.msgpack.Encoder()
_DECODER: Final[msgspec.msgpack.Decoder[Message]] = msgspec.msgpack.Decoder(Message)


def frame(content: Message | bytes) -> bytes:
    """Return a message, or a part of an answer, as the bytes that are sent."""
    if isinstance(content, bytes):
        return PREFIX.pack(len(content), _PART) + content
    body = _ENCODER.encode(content)
    return PREFIX.pack(len(body), _MESSAGE) + body


def decode(kind: int, body: bytes) -> Message | bytes:
    """Return what was sent, of the kind and with the bytes behind the prefix; ValueError for what is no message."""
    return body if kind == _PART else _DECODER.decode(body)


def _subclasses(kind: type[KgError]) -> list[type[KgError]]:
    return [kind, *(below for one in kind.__subclasses__() for below in _subclasses(one))]
