"""Asks a server things that nobody would, for some minutes: no 500, no body that does not parse, no dead server.

    python benchmarks/fuzzing STORE [--seconds 600 | --rounds 16] [--write]

STORE is a folder `.kg`, which is copied. Half of the time goes to requests that schemathesis makes of the server's own
description (`/openapi.json`), half to queries of a grammar (`grammar.py`), sent in each way that the protocol has, with
odd headers and parameters. With `--write` the server may be changed, and is told updates of the grammar too. The exit
code is 1 when something was found; a request that shows it is printed.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from contextlib import contextmanager
from itertools import cycle, islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, cast

import httpx
import schemathesis
from grammar import queries, updates
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

TOKEN: Final = "a-token-of-the-fuzzing"  # noqa: S105 - of this run
ACCEPTS: Final = st.sampled_from(
    ["*/*", "text/csv", "application/sparql-results+xml", "text/turtle", "application/ld+json", "image/png", "", "*",
     ";q", "text/html", "application/json;q=0.000, */*;q=2", "text/tab-separated-values", "a/b" * 300]
)  # fmt: skip
PARAMETERS: Final = st.dictionaries(
    st.sampled_from(
        ["limit", "offset", "format", "stream", "snapshot", "job", "default-graph-uri", "$a", "timeout", "query"]
    ),
    st.sampled_from(
        ["0", "1", "-1", "1e9", "true", "json", "csv", "", "a:g", "<a:g>", "x" * 64, "\x00", "ä", "99999999999"]
    ),
    max_size=3,
)
_BATCH: Final = 25
_ENOUGH: Final = 5
_PATIENCE: Final = 300
"""Seconds that the server may take for a request, and for its end, on a machine that is busy."""

COUNTS: Counter[int] = Counter()
FOUND: list[str] = []


def main() -> None:
    """Read the command line, ask, report."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("store", type=Path, help="the folder .kg of a store")
    parser.add_argument("--seconds", type=float, default=600, help="how long to ask")
    parser.add_argument("--rounds", type=int, help="how many batches to ask of each half, the same each time")
    parser.add_argument("--write", action="store_true", help="let the server be changed")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="kg-fuzzing-") as folder:
        copy = Path(folder) / ".kg"
        shutil.copytree(options.store, copy)
        with _served(copy, write=options.write) as (address, process, log):
            headers = {"Authorization": f"Bearer {TOKEN}"} if options.write else {}
            with httpx.Client(base_url=address, headers=headers, timeout=_PATIENCE) as client:
                for kinds in (_described(address, client), _asked(client, write=options.write)):
                    if options.rounds:
                        _times(options.rounds, kinds)
                    else:
                        _for(options.seconds / 2, kinds)
                _judge(client.get("/health"), "the server afterwards")
            if process.poll() is not None:
                FOUND.append(f"the server ended: {process.returncode}")
        said = log.read_text(errors="replace")
    print(f"{sum(COUNTS.values())} answers: " + ", ".join(f"{status} {n}" for status, n in sorted(COUNTS.items())))
    if "Traceback" in said:
        FOUND.append(said[said.index("Traceback") :][:4000])
    print("\n\n".join(FOUND) or "nothing was found")
    sys.exit(1 if FOUND else 0)


@contextmanager
def _served(store: Path, *, write: bool) -> Iterator[tuple[str, subprocess.Popen[bytes], Path]]:
    """Run the server; its log is a file, since a pipe that nobody reads would stop it."""
    log = store.parent / "log"
    command = [
        sys.executable,
        "-m",
        "kg",
        "serve",
        "--store",
        str(store),
        "--port",
        "0",
        "--timeout",
        "3",
        "--log",
        "off",
    ]
    with log.open("wb") as file:
        process = subprocess.Popen(
            [*command, *(["--write"] if write else [])], stderr=file, env={**os.environ, "KG_TOKEN": TOKEN}
        )
    try:
        yield _address(log, process), process, log
    finally:
        process.send_signal(signal.SIGTERM)
        process.wait(_PATIENCE)


def _address(log: Path, process: subprocess.Popen[bytes]) -> str:
    while process.poll() is None:
        for word in log.read_text(errors="replace").split():
            if word.startswith("http://127.0.0.1:"):
                return word.rstrip("/")
        time.sleep(0.1)
    sys.exit(f"the server did not start: {log.read_text()}")


def _times(number: int, rounds: list[Callable[[int], None]]) -> None:
    """Call so many of the functions, in turn, with the same seeds each time, until enough was found."""
    for seed_of, one in enumerate(islice(cycle(rounds), number)):
        if len(FOUND) < _ENOUGH:
            one(seed_of)


def _for(seconds: float, rounds: list[Callable[[int], None]]) -> None:
    """Call the functions in turn, with ever new seeds, until the time is over or enough was found."""
    end = time.monotonic() + seconds
    number = int(time.time())
    while time.monotonic() < end and len(FOUND) < _ENOUGH:
        for one in rounds:
            number += 1
            one(number)
            if time.monotonic() > end:
                break


def _settings() -> settings:
    return settings(
        max_examples=_BATCH,
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
        phases=[Phase.generate],
    )


def _described(address: str, client: httpx.Client) -> list[Callable[[int], None]]:
    """Return a function for each operation that the server describes."""
    schema = schemathesis.openapi.from_url(f"{address}/openapi.json", headers=dict(client.headers))
    operations = [result.ok() for result in cast("Iterator[Any]", schema.get_all_operations())]

    def ask(operation: Any) -> Callable[[int], None]:
        def round_of(number: int) -> None:
            @seed(number)
            @_settings()
            @given(case=operation.as_strategy())
            def once(case: Any) -> None:
                arguments = case.as_transport_kwargs(base_url=address)
                arguments = {name: value for name, value in arguments.items() if name != "cookies"}
                try:
                    request = client.build_request(**_of_httpx(arguments))
                except (httpx.InvalidURL, UnicodeError, ValueError, TypeError):
                    return
                _send(client, request)

            once()

        return round_of

    return [ask(operation) for operation in operations]


def _of_httpx(arguments: dict[str, Any]) -> dict[str, Any]:
    """Return arguments of `requests` as those of `httpx`."""
    named = dict(arguments)
    body = named.pop("data", None)
    if isinstance(body, dict):
        named["data"] = body
    elif body is not None:
        named["content"] = body if isinstance(body, bytes) else str(body).encode("utf-8", "replace")
    named["headers"] = {
        name: str(value).encode("latin-1", "replace") for name, value in (named.get("headers") or {}).items()
    }
    return {
        name: value
        for name, value in named.items()
        if name in {"method", "url", "params", "headers", "content", "data", "json"}
    }


def _asked(client: httpx.Client, *, write: bool) -> list[Callable[[int], None]]:
    """Return functions that ask queries, and say updates, of the grammar."""
    ways = st.sampled_from(["get", "form", "direct", "query", "view"])

    def ask(number: int) -> None:
        @seed(number)
        @_settings()
        @given(queries(), ways, ACCEPTS, PARAMETERS)
        def once(text: str, way: str, accept: str, parameters: dict[str, str]) -> None:
            _send(client, _request(client, text, way, {"Accept": accept}, parameters))

        once()

    def change(number: int) -> None:
        @seed(number)
        @_settings()
        @given(updates())
        def once(text: str) -> None:
            _send(client, client.build_request("POST", "/update", data={"update": text.encode("utf-8", "replace")}))

        once()

    return [ask, change] if write else [ask]


def _request(client: httpx.Client, text: str, way: str, headers: dict[str, str], parameters: dict[str, str]) -> Any:
    body = text.encode("utf-8", "surrogatepass")
    if way == "get":
        return client.build_request("GET", "/sparql", params={**parameters, "query": text[:2000]}, headers=headers)
    if way == "form":
        return client.build_request("POST", "/sparql", params=parameters, data={"query": text}, headers=headers)
    if way == "view":
        return client.build_request("POST", "/api/diagnose", json={"text": text}, headers=headers)
    headers["Content-Type"] = "application/sparql-query"
    method = "POST" if way == "direct" else "QUERY"
    return client.build_request(method, "/sparql", params=parameters, content=body, headers=headers)


def _send(client: httpx.Client, request: httpx.Request) -> None:
    try:
        answer = client.send(request)
    except httpx.RemoteProtocolError as error:
        # Where a body that is streamed fails, the connection is to end before it is whole.
        if "stream" not in str(request.url):
            FOUND.append(f"{error!r}\n{_shown(request)}")
        return
    except (httpx.TransportError, UnicodeError) as error:
        FOUND.append(f"{error!r}\n{_shown(request)}")
        return
    COUNTS[answer.status_code] += 1
    _judge(answer, _shown(request))


def _shown(request: httpx.Request) -> str:
    return f"{request.method} {request.url}\n{dict(request.headers)}\n{request.read()[:2000]!r}"


def _judge(answer: httpx.Response, what: str) -> None:
    """Note what must not be: 500, an error of another shape, JSON that does not parse."""
    kind = answer.headers.get("content-type", "")
    wrong = answer.status_code == 500  # noqa: PLR2004 - a status of HTTP
    if "json" in kind and "ndjson" not in kind and answer.request.method != "HEAD":
        try:
            members = json.loads(answer.content) if answer.content else {}
        except ValueError:
            wrong = True
        else:
            wrong |= kind == "application/problem+json" and not {"code", "message", "hint", "docs"} <= set(members)
    if wrong:
        FOUND.append(f"{answer.status_code} {answer.text[:500]}\n{what}")


if __name__ == "__main__":
    main()
