"""The settings of `kg serve`: flags, variables `KG_SERVE_...` and the table `[serve]` of `kg.toml`."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from kg import forms
from kg.settings import declared, setting

_DURATION: Final = forms.number(0.001)  # no timer is finer


@dataclass(frozen=True, slots=True)
class Options:
    """The address, access rules and limits of a server.

    Access rules cannot be set in files: a `kg.toml` in a checkout must not open a server to others.

    Three fields are not settings: `token` comes from `$KG_TOKEN`, `per_client` is the maximum number of concurrent
    queries of one client, and `connections` the maximum number of requests being handled, and of idle connections.
    """

    host: str = setting(
        "127.0.0.1", forms.text, "ADDRESS", "Address to listen on; by default only this machine.", in_files=False
    )
    port: int = setting(7878, forms.whole(0, 65535), "N", "Port to listen on; 0 picks a free one.")
    root_path: str = setting(
        "", forms.root_path, "PATH", "Path at which a reverse proxy publishes the server: /kg (docs/endpoint.md)."
    )
    write: bool = setting(False, forms.switch, "", "Accept updates from token holders.", in_files=False)
    token_file: Path | None = setting(
        None, forms.path, "FILE", "Read the token from FILE, and again if it changes; or set KG_TOKEN.", in_files=False
    )
    open_to_all: bool = setting(
        False, forms.switch, "", "Allow reading without a token.", option="no_auth", in_files=False
    )
    hosts: tuple[str, ...] = setting(
        (),
        forms.words,
        "NAME",
        "Accept this host name too; may be repeated.",
        option="allow_host",
        in_files=False,
        several=True,
    )
    origins: tuple[str, ...] = setting(
        (),
        forms.words,
        "ORIGIN",
        "Allow pages of this site to read (CORS); may be repeated.",
        option="cors",
        in_files=False,
        several=True,
    )
    no_union: bool = setting(
        False, forms.switch, "", "Use the unnamed graph as the default graph, not the union of all."
    )
    readers: int = setting(2, forms.whole(1, 256), "N", "Number of queries answered in parallel.")
    queue: int = setting(256, forms.whole(0, 100_000), "N", "Maximum number of waiting queries.")
    seconds: float = setting("30", _DURATION, "SECONDS", "Time limit of a query.", option="timeout")
    update_seconds: float = setting(
        "300", _DURATION, "SECONDS", "Time limit of an update, which is then undone.", option="update_timeout"
    )
    rows: int = setting(100_000, forms.whole(1), "N", "Maximum rows per answer.", option="max_rows")
    answer_bytes: int = setting("1G", forms.size, "SIZE", "Maximum size of an answer.", option="max_answer_bytes")
    body: int = setting("128M", forms.size, "SIZE", "Maximum size of a request.", option="max_body_bytes")
    memory: int = setting("2G", forms.size, "SIZE", "Memory limit of a query.", option="max_memory")
    cache: int = setting("64M", forms.size, "SIZE", "Size of the cache of answers.")
    grace: float = setting("10", _DURATION, "SECONDS", "Time for running requests to finish on shutdown.")
    log: str = setting("text", forms.one_of("text", "json", "off"), "text|json|off", "Log a line for each request.")
    slow: float | None = setting(None, _DURATION, "SECONDS", "Log queries that take longer.")
    slow_log: Path | None = setting(None, forms.path, "FILE", "Write slow queries to FILE.", in_files=False)
    robot: str | None = setting(
        None,
        forms.address,
        "ADDRESS",
        "Show this robot on a page; token holders can move it: ros1://HOST:PORT, ...",
        in_files=False,
    )
    token: str | None = field(default=None, repr=False)
    per_client: int = 32
    connections: int = 256


DECLARED: Final = declared(Options, "serve")
