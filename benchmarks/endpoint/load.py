"""The load: clients that ask queries over HTTP one after the other, each on a connection of its own.

    python benchmarks/endpoint/load.py PLAN

PLAN is JSON: `port`, `path`, `queries`, `connections`, `seconds`, and `distinct`, which adds a comment to each query so
that no two are the same text, and puts a new name in the place of `NEW`, so that no two are alike. The answer is JSON
on standard output: for each query its seconds, statuses and the bytes of its answer. It runs in a process of its own,
and reads no more of HTTP than it has to.
"""

from __future__ import annotations

import asyncio
import json
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

__all__ = ["main"]

_LETTERS = str.maketrans("0123456789 ", "abcdefghijz")


class _Client(asyncio.Protocol):
    """One connection that asks again as soon as it has been answered."""

    def __init__(self, plan: dict[str, Any], first: int, end: float, results: list[dict[str, Any]]) -> None:
        self._plan = plan
        self._next = first
        self._end = end
        self._results = results
        self._asked = 0
        self._held = bytearray()
        self._length: int | None = None
        self.done: asyncio.Future[None] = asyncio.get_running_loop().create_future()

    def connection_made(self, transport: Any) -> None:
        self._transport = transport
        self._ask()

    def connection_lost(self, _error: Exception | None) -> None:
        if not self.done.done():
            self.done.set_result(None)

    def _ask(self) -> None:
        if time.perf_counter() >= self._end:
            self._transport.close()
            return
        queries = self._plan["queries"]
        self._query = self._next % len(queries)
        self._next += 1
        self._asked += 1
        text = queries[self._query]
        if self._plan["distinct"]:
            number = f"{id(self)} {self._asked}"
            text = f"{text.replace('NEW', number.translate(_LETTERS))}\n# {number}"
        body = text.encode()
        head = (
            f"POST {self._plan['path']} HTTP/1.1\r\nHost: 127.0.0.1:{self._plan['port']}\r\n"
            "Accept: application/sparql-results+json\r\nContent-Type: application/sparql-query\r\n"
            f"Content-Length: {len(body)}\r\n\r\n"
        )
        self._held.clear()
        self._length = None
        self._began = time.perf_counter()
        self._transport.write(head.encode() + body)

    def data_received(self, data: bytes) -> None:
        self._held += data
        if self._length is None:
            end = self._held.find(b"\r\n\r\n")
            if end < 0:
                return
            head = bytes(self._held[:end]).lower()
            self._status = int(head.split(b" ", 2)[1])
            where = head.find(b"\r\ncontent-length:")
            self._length = end + 4 + int(head[where + 17 :].split(b"\r\n", 1)[0]) if where >= 0 else -1
        if self._is_whole():
            result = self._results[self._query]
            result["seconds"].append(time.perf_counter() - self._began)
            result["statuses"][self._status] += 1
            result["bytes"] = len(self._held)
            self._ask()

    def _is_whole(self) -> bool:
        if self._length == -1:
            return self._held.endswith(b"\r\n0\r\n\r\n")
        return self._length is not None and len(self._held) >= self._length


async def _load(plan: dict[str, Any]) -> dict[str, Any]:
    results: list[dict[str, Any]] = [{"seconds": [], "statuses": Counter(), "bytes": 0} for _ in plan["queries"]]
    loop = asyncio.get_running_loop()
    began = time.perf_counter()
    clients = []
    for number in range(plan["connections"]):
        first = number * len(plan["queries"]) // plan["connections"]
        client = _Client(plan, first, began + plan["seconds"], results)
        await loop.create_connection(lambda client=client: client, "127.0.0.1", plan["port"])  # type: ignore[misc]  # bound now
        clients.append(client)
    await asyncio.gather(*(client.done for client in clients))
    return {"elapsed": time.perf_counter() - began, "results": results}


def main() -> None:
    """Read the plan, ask, print what came of it."""
    print(json.dumps(asyncio.run(_load(json.loads(Path(sys.argv[1]).read_text())))))


if __name__ == "__main__":
    main()
