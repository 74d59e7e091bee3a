"""A small master for simulations and tests without a ROS installation: registrations, look-ups, parameters.

It implements the Master and Parameter Server APIs (wiki.ros.org/ROS/Master_API and ROS/Parameter%20Server%20API), and
notifies subscribers of publishers.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, Final, Self

from kg.errors import RobotError
from kg.robot.ros1.names import is_name, is_type, netloc, peer, shown
from kg.robot.ros1.xmlrpc import XmlRpcServer, call
from kg.robot.tasks import Tasks


class Parameters:
    """The parameters of a system; a namespace is a dict of its content. KeyError for a missing one."""

    def __init__(self) -> None:
        self._tree: dict[str, Any] = {}

    def get(self, name: str) -> Any:
        """Return a value, or the content of a namespace."""
        value: Any = self._tree
        for part in _parts(name):
            if not isinstance(value, dict):
                raise KeyError(name)
            value = value[part]
        return value

    def has(self, name: str) -> bool:
        """Tell whether there is a value, or a namespace."""
        try:
            self.get(name)
        except KeyError:
            return False
        return True

    def set(self, name: str, value: Any) -> None:
        """Set a value, or the content of a namespace."""
        *spaces, last = _parts(name) or [""]
        if not last:
            self._tree = value if isinstance(value, dict) else {}
            return
        within = self._tree
        for part in spaces:
            inner = within.get(part)
            within[part] = inner if isinstance(inner, dict) else {}
            within = within[part]
        within[last] = value

    def delete(self, name: str) -> None:
        """Delete a value or namespace."""
        *spaces, last = _parts(name) or [""]
        within = self.get("/".join(spaces))
        if not isinstance(within, dict):
            raise KeyError(name)
        del within[last]

    def search(self, space: str, name: str) -> str:
        """Return the name under which a parameter is found from a namespace upwards."""
        first = name.strip("/").partition("/")[0]
        parts = _parts(space)
        while True:
            if self.has("/".join(["", *parts, first])):
                return "/".join(["", *parts, name.strip("/")])
            if not parts:
                raise KeyError(name)
            parts.pop()

    def names(self) -> list[str]:
        """Return the names of all values."""
        names: list[str] = []
        pending: list[tuple[str, Any]] = [("", self._tree)]
        while pending:
            name, value = pending.pop()
            if isinstance(value, dict):
                pending += [(f"{name}/{part}", inner) for part, inner in value.items()]
            else:
                names.append(name)
        return names


def _parts(name: str) -> list[str]:
    return [part for part in name.split("/") if part]


@dataclass
class _Ends:
    """Registrations: addresses of nodes by the name of the topic or service, then by the name of the node."""

    by_name: dict[str, dict[str, str]] = field(default_factory=dict)

    def add(self, name: str, node: str, uri: str) -> None:
        self.by_name.setdefault(name, {})[node] = uri

    def remove(self, name: str, node: str, uri: str | None = None) -> int:
        """Remove a node, if it is registered with the address; return the number removed."""
        nodes = self.by_name.get(name, {})
        if node not in nodes or (uri is not None and nodes[node] != uri):
            return 0
        del nodes[node]
        if not nodes:
            del self.by_name[name]
        return 1

    def rows(self) -> list[list[Any]]:
        return [[name, list(nodes)] for name, nodes in self.by_name.items()]

    def has(self, node: str) -> bool:
        return any(node in nodes for nodes in self.by_name.values())


class Master:
    """A master that listens inside its context: `async with Master() as master: ... master.address`."""

    def __init__(self, host: str = "127.0.0.1", port: int = 0) -> None:
        self.parameters = Parameters()
        self._host = host
        self._port = port
        self._publishers = _Ends()
        self._subscribers = _Ends()
        self._services = _Ends()
        self._watching = _Ends()
        self._nodes: dict[str, str] = {}
        self._kinds: dict[str, str] = {}
        self._server = XmlRpcServer(self._handle)
        self._telling = Tasks()
        self._untold: dict[str, dict[tuple[str, Any], tuple[Any, ...]]] = {}
        ends = (self._publishers, self._subscribers, self._services)
        self._calls: dict[str, tuple[str, Callable[..., Any]]] = {
            "getPid": ("", lambda _: os.getpid()),
            "getUri": ("", lambda _: self.uri),
            "getSystemState": ("", lambda _: [one.rows() for one in ends]),
            "getTopicTypes": ("", lambda _: [list(pair) for pair in self._kinds.items()]),
            "getPublishedTopics": ("s", self._on_published),
            "lookupNode": ("n", lambda _, name: self._nodes[name]),
            "lookupService": ("n", lambda _, name: list(self._services.by_name[name].values())[-1]),
            "registerPublisher": ("ntu", self._on_publish),
            "unregisterPublisher": ("nu", self._on_unpublish),
            "registerSubscriber": ("ntu", self._on_subscribe),
            "unregisterSubscriber": ("nu", self._on_unsubscribe),
            "registerService": ("nuu", self._on_serve),
            "unregisterService": ("nu", self._on_unserve),
            "getParam": ("s", lambda _, name: self.parameters.get(name)),
            "setParam": ("sv", self._on_set),
            "deleteParam": ("s", self._on_delete),
            "hasParam": ("s", lambda _, name: self.parameters.has(name)),
            "searchParam": ("s", self.parameters.search),
            "getParamNames": ("", lambda _: self.parameters.names()),
            "subscribeParam": ("us", self._on_watch),
            "unsubscribeParam": ("us", lambda caller, uri, name: self._watching.remove(name, caller, uri)),
        }
        """The methods of the API: the kinds of arguments after the caller's name (`_CHECKS`), and the response."""

    @property
    def address(self) -> str:
        """The address for `kg.robot.connecting.connect`."""
        return f"ros1://{netloc(self._host, self._port)}"

    @property
    def uri(self) -> str:
        """The address in the form of `$ROS_MASTER_URI`."""
        return f"http://{netloc(self._host, self._port)}/"

    async def __aenter__(self) -> Self:
        """Listen; RobotError KG814 if the address is not available."""
        try:
            self._port = await self._server.start(self._host, self._port)
        except OSError as error:
            hint = "Take another port: 0 is a free one." if error.errno == errno.EADDRINUSE else None
            raise RobotError("KG814", f"no master can listen at {self.address}: {error}", hint=hint) from None
        return self

    async def __aexit__(self, *_: object) -> None:
        self._telling.cancel()
        await self._server.aclose()

    async def _handle(self, method: str, arguments: list[Any]) -> Any:
        if method != "system.multicall":
            return self._answer(method, arguments)
        answers: list[Any] = []
        for wanted in arguments[0] if arguments and isinstance(arguments[0], list) else []:
            match wanted:
                case {"methodName": str(each), "params": list(given)} if each in self._calls:
                    answers.append([self._answer(each, given)])
                case _:
                    answers.append({"faultCode": 1, "faultString": "it is not a call"})
        return answers

    def _answer(self, method: str, arguments: list[Any]) -> list[Any]:
        """Respond to a call with code, message and value; KeyError for an unknown method."""
        shape, answer = self._calls[method]
        # Only callers that register need the name of a node: those of tools are invalid, such as `/rosparam-1234`.
        is_caller = _CHECKS["n" if "u" in shape else "s"]
        if len(arguments) != len(shape) + 1 or not is_caller(arguments[0]):
            return [-1, f"{method} needs a caller and {len(shape)} arguments", 0]
        checked = [_CHECKS[sign](value) for sign, value in zip(shape, arguments[1:], strict=True)]
        if not all(checked):
            return [-1, f"{method}: `{shown(arguments[1 + checked.index(False)])}` does not fit", 0]
        try:
            return [1, "", answer(_slashed(arguments[0]), *arguments[1:])]
        except KeyError:
            return [-1, f"{method}: unknown {shown(arguments[1])}", "" if method in _TEXTS else 0]

    def _on_published(self, _: str, space: str) -> list[Any]:
        inside = space.rstrip("/") + "/"
        return [[topic, self._kinds.get(topic, "*")] for topic in self._publishers.by_name if topic.startswith(inside)]

    def _on_publish(self, caller: str, topic: str, kind: str, uri: str) -> list[str]:
        self._welcome(caller, uri)
        if kind != "*" and (self._kinds.get(topic, "*") == "*" or topic not in self._publishers.by_name):
            self._kinds[topic] = kind
        self._publishers.add(topic, caller, uri)
        self._notify_publishers(topic)
        return list(self._subscribers.by_name.get(topic, {}).values())

    def _on_unpublish(self, caller: str, topic: str, uri: str) -> int:
        count = self._publishers.remove(topic, caller, uri)
        if count:
            self._notify_publishers(topic)
            self._forget([caller], topic)
        return count

    def _on_subscribe(self, caller: str, topic: str, kind: str, uri: str) -> list[str]:
        self._welcome(caller, uri)
        self._kinds.setdefault(topic, kind)
        if self._kinds[topic] == "*":
            self._kinds[topic] = kind
        self._subscribers.add(topic, caller, uri)
        return list(self._publishers.by_name.get(topic, {}).values())

    def _on_unsubscribe(self, caller: str, topic: str, uri: str) -> int:
        count = self._subscribers.remove(topic, caller, uri)
        self._forget([caller], topic)
        return count

    def _on_serve(self, caller: str, service: str, service_uri: str, uri: str) -> int:
        self._welcome(caller, uri)
        self._services.by_name[service] = {caller: service_uri}
        return 1

    def _on_unserve(self, caller: str, service: str, service_uri: str) -> int:
        count = self._services.remove(service, caller, service_uri)
        self._forget([caller])
        return count

    def _on_set(self, caller: str, name: str, value: Any) -> int:
        self.parameters.set(name, value)
        for watched, nodes in self._watching.by_name.items():
            if f"{name}/".startswith(f"{watched}/"):
                self._notify([uri for node, uri in nodes.items() if node != caller], "paramUpdate", name, value)
        return 0

    def _on_delete(self, _: str, name: str) -> int:
        self.parameters.delete(name)
        return 0

    def _on_watch(self, caller: str, uri: str, name: str) -> Any:
        self._watching.add(name, caller, uri)
        return self.parameters.get(name) if self.parameters.has(name) else {}

    def _welcome(self, caller: str, uri: str) -> None:
        """Register a node; another one of the same name at another address is shut down and removed."""
        before = self._nodes.get(caller)
        if before is not None and before != uri:
            self._notify([before], "shutdown", f"a new node registered as {caller}")
            for ends in (self._publishers, self._subscribers, self._services, self._watching):
                for name in [name for name, nodes in ends.by_name.items() if caller in nodes]:
                    ends.remove(name, caller)
        self._nodes[caller] = uri

    def _forget(self, nodes: Iterable[str], topic: str | None = None) -> None:
        """Remove nodes without registrations, and the types of topics without ends."""
        ends = (self._publishers, self._subscribers, self._services)
        for node in nodes:
            if not any(one.has(node) for one in ends):
                self._nodes.pop(node, None)
        if topic is not None and not any(topic in one.by_name for one in ends[:2]):
            self._kinds.pop(topic, None)

    def _notify_publishers(self, topic: str) -> None:
        publishers = list(self._publishers.by_name.get(topic, {}).values())
        self._notify(self._subscribers.by_name.get(topic, {}).values(), "publisherUpdate", topic, publishers)

    def _notify(self, uris: Iterable[str], method: str, *arguments: Any) -> None:
        """Notify nodes without waiting: in order, and only of the newest state of a topic or parameter."""
        for uri in uris:
            if uri not in self._untold:
                self._untold[uri] = {}
                self._telling.spawn(self._send_pending(uri), f"telling {uri} of changes")
            self._untold[uri].pop((method, arguments[0]), None)
            self._untold[uri][method, arguments[0]] = arguments

    async def _send_pending(self, uri: str) -> None:
        untold = self._untold[uri]
        try:
            while untold:
                method, about = next(iter(untold))
                arguments = untold.pop((method, about))
                with suppress(RobotError):  # a dead node needs no notification
                    await call(uri, method, "/master", *arguments)
        finally:
            del self._untold[uri]


def _slashed(name: object) -> object:
    return name if not isinstance(name, str) or name.startswith("/") else f"/{name}"


def _is_uri(value: object) -> bool:
    scheme = "rosrpc" if isinstance(value, str) and value.startswith("rosrpc") else "http"
    try:
        peer(value, scheme)
    except RobotError:
        return False
    return True


_TEXTS: Final = frozenset({"lookupNode", "lookupService", "searchParam"})
"""Calls that answer "" where there is nothing; others answer 0."""
_CHECKS: Final[dict[str, Callable[[object], bool]]] = {
    "n": lambda value: is_name(_slashed(value)),
    "t": lambda value: value == "*" or is_type(value),
    "u": _is_uri,
    "s": lambda value: isinstance(value, str),
    "v": lambda _: True,
}
