"""Protocol between a reader and its owner.

A message is a frame: its length (four bytes, big-endian), its kind (one byte), then MessagePack, or plain bytes for a
part of a response. For each request, a reader sends `Head`, any number of parts and `Progress`, and `End`; or `Failure`
at any time.
"""

from __future__ import annotations

import struct
import traceback
from typing import Any, BinaryIO, Final, TypeAlias

import msgspec

from kg.errors import KgError, Place, QueryError
from kg.store.failure import is_of_store, store_error

PREFIX: Final = struct.Struct(">IB")
"""Length of the body, and its kind."""

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

    `formats` contains the format of the response for each acceptable kind of result (`rows`, `boolean`, `graph`; see
    `kg.query.formats`). `parameters` binds variables to terms in N-Triples syntax. `default_graphs` and `named_graphs`
    replace the dataset of the query (SPARQL 1.1 Protocol, section 2.1.4). Without them the default graph is the union
    of all graphs, or the unnamed graph if `union` is false. `rows` limits rows or triples, after skipping the first
    `offset`; `size` limits the bytes of the response (KG511). `snapshot` requires data of that identity (KG512). `path`
    is the path of the text in errors, `base` the base of relative IRIs, which are errors without one.
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
    """Call of a function in `Configuration.calls`, which returns JSON."""

    name: str
    arguments: dict[str, Any] = {}


class Ready(msgspec.Struct, frozen=True, tag="ready"):
    """Sent once by a reader with process ID `pid`: it has tried to open the current data, and accepts requests."""

    pid: int


class Refresh(msgspec.Struct, frozen=True, tag="refresh"):
    """Sent to an idle reader: the data may have changed, so close outdated data."""


class Head(msgspec.Struct, frozen=True, tag="head"):
    """Head of a response: `kind` is `rows`, `boolean`, `graph` or `json`, `format` its serialization.

    `snapshot` is the identity of the data. `repeatable` is whether the same request on the same data has the same
    response. It is false for queries with NOW or RAND, and for views, for which it is unknown.
    """

    kind: str
    format: str
    snapshot: str
    variables: tuple[str, ...] = ()
    repeatable: bool = True


class Progress(msgspec.Struct, frozen=True, tag="progress"):
    """Number of rows or triples found so far; sent at most ten times a second."""

    rows: int


class End(msgspec.Struct, frozen=True, tag="end"):
    """End of a whole response; `more` is whether the limit of rows cut it.

    `last` is whether the reader has grown large or still runs threads; it must not receive another request.
    """

    rows: int
    seconds: float
    more: bool = False
    last: bool = False


class Failure(msgspec.Struct, frozen=True, tag="failure"):
    """An error of `kg` or of the engine; any earlier part of the response is void.

    `last` is as in `End`.
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
        """Return an error as a message."""
        place = error.place
        position = tuple(getattr(place, name) for name in Place.__dataclass_fields__) if place else ()
        return cls(error.code, error.message, type(error).__name__, error.hint, *position)

    def error(self) -> KgError:
        """Return the message as an error."""
        place = None
        if self.path is not None:
            place = Place(self.path, self.line, self.column, self.excerpt, self.end_line, self.end_column)
        kinds = {kind.__name__: kind for kind in _subclasses(KgError)}
        return kinds.get(self.kind, QueryError)(self.code, self.message, place=place, hint=self.hint)


Message: TypeAlias = Configuration | Question | Call | Ready | Refresh | Head | Progress | End | Failure

_ENCODER: Final = msgspec.msgpack.Encoder()
_DECODER: Final[msgspec.msgpack.Decoder[Message]] = msgspec.msgpack.Decoder(Message)


def frame(content: Message | bytes) -> bytes:
    """Return a message, or a part of a response, as a frame."""
    if isinstance(content, bytes):
        return PREFIX.pack(len(content), _PART) + content
    body = _ENCODER.encode(content)
    return PREFIX.pack(len(body), _MESSAGE) + body


def decode(kind: int, body: bytes) -> Message | bytes:
    """Return the message or part with this kind and body; ValueError if it is malformed."""
    return body if kind == _PART else _DECODER.decode(body)


def _subclasses(kind: type[KgError]) -> list[type[KgError]]:
    return [kind, *(below for one in kind.__subclasses__() for below in _subclasses(one))]


_NO_THREAD: Final = "can't start new thread"
"""Message of Python if the stack of a thread cannot be allocated."""


def received(requests: BinaryIO) -> Message | bytes | None:
    """Return the next message; None at the end of the stream."""
    prefix = requests.read(PREFIX.size)
    if len(prefix) < PREFIX.size:
        return None
    length, kind = PREFIX.unpack(prefix)
    return decode(kind, requests.read(length))


def failure(error: Exception, what: str) -> Failure:
    """Return the error of `what` (such as "query") as a message for the owner of this process.

    The code is KG507 for a lack of memory, and one of the store's codes for errors of the system. Unexpected exceptions
    are KG900; their traceback is written to standard error.
    """
    if isinstance(error, KgError):
        return Failure.of(error)
    if isinstance(error, MemoryError) or str(error) == _NO_THREAD:
        return Failure("KG507", f"the {what} needs more memory than it may use")
    if is_of_store(error):
        return Failure.of(store_error(error, "the store"))
    traceback.print_exception(error)
    return Failure("KG900", f"a defect in kg: {type(error).__name__}: {error}", "KgError")
