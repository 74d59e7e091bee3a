"""ROS 2 over Zenoh: a session compatible with rmw_zenoh_cpp."""

from __future__ import annotations

import asyncio
import json
from functools import partial
from itertools import count
from typing import TYPE_CHECKING, Any, Final

import zenoh
from zenoh import CongestionControl, Sample, SampleKind, Session

from kg.errors import RobotError
from kg.facts import Qos, Role
from kg.robot.connection import GraphProblem, LiveEnd, LiveNode
from kg.robot.ros2.middleware import ANSWERS, Deliver, Neighbourhood
from kg.robot.ros2.types import type_hash
from kg.robot.tasks import call_in
from kg.robot.zenoh.ends import End, ZenohCaller, ZenohServer, ZenohWriter
from kg.robot.zenoh.tokens import NO_HASH, Token, data_key, pattern

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from kg.robot.messages import Types
    from kg.robot.ros2.graph import Watch

_PORT: Final = 7447
_OPENING: Final = 3000  # milliseconds for the router or peer to answer
_MOST: Final = 100_000


def configuration(place: str) -> zenoh.Config:
    """Return the settings of a session connected to `HOST:PORT`, as those of rmw_zenoh_cpp for a node."""
    host, _, port = place.rpartition(":") if ":" in place.rpartition("]")[2] else (place, "", "")
    if not (port or str(_PORT)).isdecimal():
        raise RobotError("KG801", f"`{place}` has no numeric port", hint="Write HOST:PORT, as in localhost:7447.")
    config = zenoh.Config()
    settings: dict[str, Any] = {
        "mode": "peer",
        "connect/endpoints": [f"tcp/{host or 'localhost'}:{port or _PORT}"],
        "connect/timeout_ms": _OPENING,
        "connect/exit_on_failure": True,
        "listen/endpoints": ["tcp/localhost:0"],
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": True,
        "timestamping/enabled": True,
    }
    for key, value in settings.items():
        config.insert_json5(key, json.dumps(value))
    return config


class ZenohMiddleware:
    """Our session, with one node."""

    def __init__(self, session: Session, domain: int, name: str, types: Types) -> None:
        self.types = types
        self._session = session
        self._domain = domain
        self._name = name
        self._own = str(session.zid())
        self._tokens: dict[str, Token] = {}
        self._broken: dict[str, GraphProblem] = {}
        self._hashes: dict[tuple[str, bool], str] = {}
        self._numbers = count(1)

    def begin(self, watch: Watch) -> None:
        """Watch the tokens of others, and declare that of our node."""
        self._watch = watch
        liveliness = self._session.liveliness()
        forward = partial(call_in, asyncio.get_running_loop(), self._hear)
        self._listening = liveliness.declare_subscriber(pattern(self._domain), forward, history=True)
        self._node = liveliness.declare_token(Token(self._domain, self._own, self._name).key)

    def _hear(self, sample: Sample) -> None:
        key = str(sample.key_expr)
        if sample.kind == SampleKind.DELETE:
            self._tokens.pop(key, None)
            self._broken.pop(key, None)
        elif len(self._tokens) + len(self._broken) < _MOST:
            try:
                self._tokens[key] = Token.read(key)
            except ValueError as error:
                self._broken[key] = GraphProblem("KG816", key[:80], f"a token of liveliness is broken: {error}")
        self._watch.changed()

    def neighbourhood(self) -> Neighbourhood:
        """Return the nodes and ends of other sessions."""
        others = [token for token in self._tokens.values() if token.session != self._own]
        nodes = {(token.node, token.session) for token in others}
        ends = [LiveEnd(one.node, one.role, one.name, one.kind, one.qos) for one in others if one.role is not None]
        problems = [*self._broken.values(), *filter(None, map(self._differing, others))]
        return Neighbourhood(
            tuple(LiveNode(name, f"session {session}") for name, session in sorted(nodes)), tuple(ends), tuple(problems)
        )

    def _differing(self, token: Token) -> GraphProblem | None:
        """Return the problem of an end with another definition of a type than ours."""
        if token.role is None or token.kind is None or token.hash == NO_HASH:
            return None
        service = token.role.channel == "service"
        try:
            ours = self._hash(token.kind, service=service)
        except RobotError:
            return None
        if token.hash == ours:
            return None
        return GraphProblem("KG806", token.name, f"{token.node} has another definition of {token.kind} ({token.hash})")

    def _hash(self, kind: str, *, service: bool = False) -> str:
        if (kind, service) not in self._hashes:
            self._hashes[kind, service] = type_hash(self.types, kind, service=service)
        return self._hashes[kind, service]

    def _matching(self, role: Role, name: str) -> list[Token]:
        return [one for one in self._tokens.values() if one.role is role and one.name == name]

    def _token(self, role: Role, name: str, kind: str, qos: Qos) -> tuple[Any, Callable[[], int]]:
        digest = self._hash(kind, service=role.channel == "service")
        token = Token(self._domain, self._own, self._name, role, name, kind, digest, qos, next(self._numbers))
        declared = self._session.liveliness().declare_token(token.key)
        return declared, lambda: len(self._matching(role.opposite, name))

    def reader(self, topic: str, kind: str, qos: Qos, deliver: Deliver) -> End:
        """Open a reader of a topic; publishers with another hash are not received, and reported in the graph."""
        key = data_key(self._domain, topic, kind, "*")
        hashes = {self._hash(kind), NO_HASH}  # the key has a pattern for the hash, so that two forms are received

        def take(sample: Sample) -> None:
            if str(sample.key_expr).rpartition("/")[2] in hashes:
                deliver(sample.payload.to_bytes(), None)

        forward = partial(call_in, asyncio.get_running_loop(), take)
        if qos.durability == "transient_local":
            history = zenoh.ext.HistoryConfig(detect_late_publishers=True, max_samples=max(qos.depth or 1, 1))
            subscriber: Any = zenoh.ext.declare_advanced_subscriber(self._session, key, forward, history=history)
        else:
            subscriber = self._session.declare_subscriber(key, forward)
        return End(*self._token(Role.SUBSCRIBES, topic, kind, qos), subscriber)

    def writer(self, topic: str, kind: str, qos: Qos) -> ZenohWriter:
        """Open a writer of a topic."""
        key = data_key(self._domain, topic, kind, self._hash(kind))
        control = CongestionControl.DROP if qos.reliability == "best_effort" else CongestionControl.BLOCK
        if qos.durability == "transient_local":
            publisher: Any = zenoh.ext.declare_advanced_publisher(
                self._session,
                key,
                congestion_control=control,
                cache=zenoh.ext.CacheConfig(max_samples=max(qos.depth or 1, 1)),
                publisher_detection=True,
            )
        else:
            publisher = self._session.declare_publisher(key, congestion_control=control)
        return ZenohWriter(*self._token(Role.PUBLISHES, topic, kind, qos), publisher, f"{self._own} {key}")

    def caller(self, service: str, kind: str) -> ZenohCaller:
        """Open a client of a service, with the hash announced by its server."""

        def key() -> str:
            digests = [one.hash for one in self._matching(Role.SERVICES, service)]
            ours = self._hash(kind, service=True)
            digest = ours if ours in digests or not digests else digests[0]
            if digest not in {ours, NO_HASH}:
                raise RobotError("KG806", f"the server of `{service}` has another definition of {kind} ({digest})")
            return data_key(self._domain, service, kind, digest, service=True)

        return ZenohCaller(*self._token(Role.CLIENTS, service, kind, ANSWERS), self._session, key)

    def server(self, service: str, kind: str, answer: Callable[[bytes], Awaitable[bytes]]) -> ZenohServer:
        """Serve a service."""
        key = data_key(self._domain, service, kind, self._hash(kind, service=True), service=True)
        return ZenohServer(self._session, key, answer, lambda: self._token(Role.SERVICES, service, kind, ANSWERS))

    def hashes(self, name: str) -> list[tuple[str, str]]:
        """Return the nodes with an end of a topic or service, each with the hash of its type."""
        others = (one for one in self._tokens.values() if one.session != self._own)
        return [(one.node, one.hash) for one in others if one.name == name and one.hash != NO_HASH]

    async def learn(self, kind: str, name: str) -> bool:
        """Return whether a type is known: Zenoh itself only announces hashes."""
        del name
        return self.types.has(kind)

    def close(self) -> None:
        """Leave; closing the session undeclares everything."""
        if not self._session.is_closed():
            self._session.close()  # type: ignore[no-untyped-call]  # untyped in the library
