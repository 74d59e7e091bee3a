"""The order of declarations to other peers."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, cast

import pytest
from robot.connections import types_for_tests

pytest.importorskip("zenoh", reason="the extra `zenoh` is not installed")

from kg.robot.ros2.middleware import ANSWERS
from kg.robot.zenoh.middleware import ZenohMiddleware

if TYPE_CHECKING:
    from collections.abc import Callable


class _Session:
    """A session that records the order of its declarations."""

    def __init__(self) -> None:
        self.declared: list[str] = []

    def zid(self) -> str:
        return "a1"

    def liveliness(self) -> _Session:
        return self

    def __getattr__(self, name: str) -> Callable[..., None]:
        return lambda *_, **__: self.declared.append(name)


@pytest.mark.parametrize("kind", ["subscriber", "publisher", "queryable"])
def test_others_are_told_of_what_is_there(kind: str) -> None:
    """A peer that sees a token of an end may use the end at once, so the token is declared last."""

    async def answer(request: bytes) -> bytes:
        return request

    async def scene() -> list[str]:
        session = _Session()
        wire = ZenohMiddleware(cast("Any", session), 0, "/kg", types_for_tests(2))
        if kind == "subscriber":
            wire.reader("/said", "std_msgs/String", ANSWERS, lambda *_: None)
        elif kind == "publisher":
            wire.writer("/said", "std_msgs/String", ANSWERS)
        else:
            wire.server("/double", "kg_test/Double", answer)
        return session.declared

    assert asyncio.run(scene()) == [f"declare_{kind}", "declare_token"]
