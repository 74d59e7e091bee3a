"""What every node of ROS 2 offers: its log on `/rosout`, and the services of its parameters.

Our nodes have one parameter, `use_sim_time`, which the address sets (`?clock=simulated`). The rules are those of rclpy:
a request with an unknown name has an empty response, and a read-only parameter is not set.
"""

from __future__ import annotations

import re
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from kg.facts import Qos
from kg.robot.clock import SimulatedClock, stamp

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.robot.connection import Level, Value
    from kg.robot.ros2.connection import Ros2Connection
    from kg.robot.ros2.middleware import Writer

_LOG: Final = "rcl_interfaces/Log"
_KEPT: Final = Qos("reliable", "transient_local", "keep_last", 1000, lifespan=10.0)
"""QoS of `/rosout` (rcl_qos_profile_rosout_default)."""
_NAME: Final = "use_sim_time"
_BOOLEAN: Final = 1
_LEVELS: Final[Mapping[Level, int]] = {"info": 20, "warning": 30, "error": 40}  # constants of rcl_interfaces/Log
_WORDS: Final = re.compile(r"(?<!^)(?=[A-Z])")


class NodeInterfaces:
    """The log and the parameters of our node."""

    def __init__(self, connection: Ros2Connection) -> None:
        self._connection = connection
        self._writer: Writer | None = None
        self._logger = connection.name.strip("/").replace("/", ".")

    async def serve(self) -> None:
        """Offer them."""
        self._open_log()
        for kind, answer in {
            "DescribeParameters": self._describe,
            "GetParameterTypes": self._types,
            "GetParameters": self._values,
            "ListParameters": self._list,
            "SetParameters": self._set,
            "SetParametersAtomically": self._set_all,
        }.items():
            name = f"{self._connection.name}/{_WORDS.sub('_', kind).lower()}"
            await self._connection.serve(name, f"rcl_interfaces/{kind}", answer)

    def log(self, level: Level, message: str) -> None:
        """Publish a line of the log; a robot that is lost gets none."""
        now = stamp(self._connection.clock.now())
        line = {"stamp": now, "level": _LEVELS[level], "name": self._logger, "msg": message}
        content = self._connection.types.encode(_LOG, line)
        with suppress(Exception):  # whatever the middleware raises, a log does not end the work that it reports about
            self._open_log().write(content)

    def _open_log(self) -> Writer:
        if self._writer is None:
            self._writer = self._connection.wire.writer("/rosout", _LOG, _KEPT)
        return self._writer

    def end(self) -> None:
        """Close the log."""
        if self._writer is not None:
            self._writer.close()

    async def _describe(self, request: Value) -> Value:
        descriptor = {
            "name": _NAME,
            "type": _BOOLEAN,
            "description": "Whether the time is that of /clock; set by the address that kg connects to.",
            "read_only": True,
        }
        return {"descriptors": self._each(request, descriptor)}

    async def _types(self, request: Value) -> Value:
        return {"types": self._each(request, _BOOLEAN)}

    async def _values(self, request: Value) -> Value:
        simulated = isinstance(self._connection.clock, SimulatedClock)
        return {"values": self._each(request, {"type": _BOOLEAN, "bool_value": simulated})}

    def _each(self, request: Value, answer: Any) -> list[Any]:
        names = request["names"]
        return [answer for _ in names] if set(names) <= {_NAME} else []

    async def _list(self, request: Value) -> Value:
        wanted = request["prefixes"]
        return {"result": {"names": [_NAME] if not wanted or _NAME in wanted else []}}

    async def _set(self, request: Value) -> Value:
        return {"results": [_refused(one) for one in request["parameters"]]}

    async def _set_all(self, request: Value) -> Value:
        refused = [_refused(one) for one in request["parameters"]]
        return {"result": refused[0] if refused else {"successful": True}}


def _refused(parameter: Mapping[str, object]) -> Value:
    name = parameter["name"]
    why = "it is read-only" if name == _NAME else "it is not declared"
    return {"successful": False, "reason": f"parameter '{name}' cannot be set because {why}"}
