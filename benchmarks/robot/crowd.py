"""A crowd of nodes of ROS 1 in one process: each has an XML-RPC server and a port of TCPROS of its own."""

from __future__ import annotations

import asyncio
import sys
from typing import Any, Final

from kg.robot.messages import Types
from kg.robot.ros1.header import pack, read_header
from kg.robot.ros1.xmlrpc import XmlRpcServer, call

_KINDS: Final = ("std_msgs/String", "geometry_msgs/Twist", "sensor_msgs/LaserScan", "nav_msgs/Odometry")
_SERVICES: Final = {"get_loggers": "roscpp/GetLoggers", "set_logger_level": "roscpp/SetLoggerLevel"}
_OWN_SERVICE: Final = "std_srvs/Trigger"
_SUM: Final = Types(1).md5(_OWN_SERVICE)


async def _slave(method: str, _: list[Any]) -> Any:
    return [1, "", 4711 if method == "getPid" else 0]


async def _service(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    await read_header(reader)
    writer.write(pack({"callerid": "/crowd", "type": _OWN_SERVICE, "md5sum": _SUM}))
    writer.close()


def _calls(name: str, uri: str, service_uri: str, share: range) -> list[dict[str, Any]]:
    """Return the registrations of a node: its share of the topics, as many of others', and three services."""
    own = [(topic, _KINDS[topic % len(_KINDS)]) for topic in share]
    nexts = [(topic + 1) % share.stop for topic in share]
    others = [(topic, _KINDS[topic % len(_KINDS)]) for topic in nexts]
    calls = [("registerPublisher", [name, f"/topic{topic}", kind, uri]) for topic, kind in own]
    calls += [("registerSubscriber", [name, f"/topic{topic}", kind, uri]) for topic, kind in others]
    calls += [("registerService", [name, f"{name}/{one}", service_uri, uri]) for one in (*_SERVICES, "trigger")]
    return [{"methodName": method, "params": params} for method, params in calls]


async def crowd(master: str, nodes: int, topics: int) -> None:
    """Register a crowd and answer for it, for ever."""
    for number in range(nodes):
        slave = XmlRpcServer(_slave)
        port = await slave.start("127.0.0.1")
        tcpros = await asyncio.start_server(_service, "127.0.0.1", 0)
        service = f"rosrpc://127.0.0.1:{tcpros.sockets[0].getsockname()[1]}"
        calls = _calls(f"/node{number}", f"http://127.0.0.1:{port}/", service, range(number, topics, nodes))
        await call(master, "system.multicall", calls, seconds=30)
    print("ready", flush=True)
    await asyncio.Event().wait()


if __name__ == "__main__":
    asyncio.run(crowd(sys.argv[1], int(sys.argv[2]), int(sys.argv[3])))
