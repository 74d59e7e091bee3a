"""What `kg serve` can be told, beside the settings."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["Options"]


@dataclass(frozen=True, slots=True)
class Options:
    """How a server answers, who may ask, and within which limits.

    Where: it listens at `host` and `port` (0 for a free one); `hosts` are further names it answers to, `origins` the
    other sites that may read. Who: without `write` every change is refused; changes need `token`, or what the file
    `token_file` holds when the request comes, and on a host that others reach reading does too, unless `open_to_all`.

    How much: `readers` queries run at a time and `queue` may wait, `per_client` of one client; `seconds` is the
    deadline of a query and `update_seconds` that of a change, `rows` the cap of an answer and `answer_bytes` its size,
    `memory` that of a reader in bytes, `cache` that of answers kept for who asks the same again, `body` the size of a
    request. With `union` the default graph is the union of all graphs, else the unnamed one. `grace` is how many
    seconds requests have to end when the server stops. At most `connections` are answered at a time, and as many wait
    for a request.

    With `robot`, the address of one, pages show it; who has the token may move it.

    Said about it: `log` (text, json or off) is a line to standard error for each request; a query that takes `slow`
    seconds is written with its text to the file `slow_log`, or to standard error.
    """

    host: str = "127.0.0.1"
    port: int = 7878
    hosts: tuple[str, ...] = ()
    origins: tuple[str, ...] = ()
    write: bool = False
    token: str | None = field(default=None, repr=False)
    token_file: Path | None = None
    open_to_all: bool = False
    readers: int = 2
    queue: int = 256
    per_client: int = 32
    seconds: float = 30.0
    update_seconds: float = 300.0
    rows: int = 100_000
    answer_bytes: int = 1 << 30
    memory: int = 2 << 30
    cache: int = 64 << 20
    body: int = 128 << 20
    union: bool = True
    connections: int = 256
    grace: float = 10.0
    log: str = "text"
    slow: float | None = None
    slow_log: Path | None = None
    robot: str | None = None
