"""ROS 1: how long the graph of many nodes takes, and what messages lose on the way to a node of rospy and back.

`python benchmarks/robot ros1`. The nodes of the crowd are a process of their own, and so is the master: Debian's
rosmaster where it is installed, or that of kg.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError
from kg.robot.ros1 import Master, connect
from kg.robot.ros1.graph import Analyzer
from kg.robot.ros1.xmlrpc import ask

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.ros1 import Ros1Connection

__all__ = ["main", "serve_master"]

_NODES: Final = 500
_TOPICS: Final = 2000
_RUNS: Final = 5
_RATE: Final = 100
_SECONDS: Final = 20
_ROSMASTER: Final = Path("/usr/bin/rosmaster")
_ECHO: Final = """
import rospy
from geometry_msgs.msg import Twist
rospy.init_node("echo", disable_signals=True)
back = rospy.Publisher("/back", Twist, queue_size=1000, tcp_nodelay=True)
rospy.Subscriber("/there", Twist, back.publish, queue_size=1000, tcp_nodelay=True)
print("ready", flush=True)
rospy.sleep(6000)
"""


@contextlib.contextmanager
def _running(port: int, *command: str, ready: bool = True) -> Iterator[None]:
    with tempfile.TemporaryDirectory() as home:
        environment = {"PATH": "/usr/bin:/bin", "ROS_IP": "127.0.0.1", "HOME": home, "LC_ALL": "C.UTF-8"}
        environment["ROS_MASTER_URI"] = f"http://127.0.0.1:{port}"
        with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE) as process:
            try:
                if ready and process.stdout is not None:
                    process.stdout.readline()
                yield
            finally:
                process.kill()


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


async def serve_master(port: int) -> None:
    """Run the master of `kg` at a port until this process ends."""
    async with Master(port=port):
        print("ready", flush=True)
        await asyncio.Event().wait()


async def _listening(port: int) -> None:
    for _ in range(100):
        try:
            await ask(f"http://127.0.0.1:{port}/", "getPid", "/bench")
        except RobotError:
            await asyncio.sleep(0.1)
        else:
            return


@contextlib.contextmanager
def _master(name: str, port: int) -> Iterator[None]:
    own = (sys.executable, str(Path(__file__).parent), "master", str(port))
    command = (str(_ROSMASTER), "--core", "-p", str(port)) if name == "rosmaster" else own
    with _running(port, *command, ready=name != "rosmaster"):
        asyncio.run(_listening(port))
        yield


async def _analyze(port: int) -> None:
    connection: Ros1Connection = await connect(f"ros1://127.0.0.1:{port}", "/bench", None)
    first: list[float] = []
    again: list[float] = []
    own: list[float] = []
    for _ in range(_RUNS):
        analyzer = Analyzer(connection.node)
        for found in (first, again):
            began, worked = time.perf_counter(), time.process_time()
            graph = await analyzer.read()
            found.append(time.perf_counter() - began)
            own.append(time.process_time() - worked)
    typed = sum(end.type is not None for end in graph.ends)
    print(
        f"  {len(graph.nodes)} nodes, {len({end.name for end in graph.ends})} names, {len(graph.ends)} ends,", end=" "
    )
    print(f"{typed} of them with a type, {len(graph.problems)} problems")
    print(f"  first reading {_spread(first)}; again, nothing having changed, {_spread(again)}")
    print(f"  of them time of our processor {_spread(own[::2])} and {_spread(own[1::2])}")
    await _change(connection)
    await connection.aclose()


async def _change(connection: Ros1Connection) -> None:
    """Measure how long it takes until a new topic is seen in this graph."""
    other = await connect(connection.address, "/other", None)
    changes = connection.changes()
    await anext(changes)
    waited = []
    for number in range(_RUNS):
        await asyncio.sleep(0.37)
        began = time.perf_counter()
        await other.advertise(f"/new{number}", "std_msgs/String")
        while not any(end.name == f"/new{number}" for end in (await anext(changes)).ends):
            pass
        waited.append(time.perf_counter() - began)
    print(f"  a new topic is told after {_spread(waited)}")
    await other.aclose()


async def _echo(port: int) -> None:
    connection: Ros1Connection = await connect(f"ros1://127.0.0.1:{port}", "/bench", None)
    there = await connection.advertise("/there", "geometry_msgs/Twist")
    back = await connection.subscribe("/back", "geometry_msgs/Twist", queue=1000)
    while not (there.peers and back.connected):  # noqa: ASYNC110 - ROS 1 tells nobody how many peers it has
        await asyncio.sleep(0.05)
    sent: dict[int, float] = {}
    came: dict[int, float] = {}

    async def receive() -> None:
        async for message in back:
            came[int(message.value["linear"]["x"])] = time.perf_counter()

    receiving = asyncio.ensure_future(receive())
    began = time.perf_counter()
    for number in range(_RATE * _SECONDS):
        await asyncio.sleep(max(began + number / _RATE - time.perf_counter(), 0))
        sent[number] = time.perf_counter()
        await there.publish({"linear": {"x": float(number)}})
    await asyncio.sleep(0.5)
    receiving.cancel()
    _report(sent, came)
    await connection.aclose()


def _report(sent: dict[int, float], came: dict[int, float]) -> None:
    trips = sorted((came[number] - sent[number]) * 1000 for number in came)
    pauses = [(came[number + 1] - came[number]) * 1000 for number in came if number + 1 in came]
    print(f"  sent {len(sent)}, came back {len(came)}, lost {len(sent) - len(came)}")
    print(
        f"  there and back: median {statistics.median(trips):.2f} ms, 99 % {trips[int(0.99 * len(trips))]:.2f} ms,",
        end=" ",
    )
    print(f"most {trips[-1]:.2f} ms")
    print(f"  between two: mean {statistics.mean(pauses):.2f} ms, deviation {statistics.pstdev(pauses):.2f} ms")


def _spread(seconds: list[float]) -> str:
    return f"{statistics.median(seconds):.2f} s ({min(seconds):.2f} to {max(seconds):.2f})"


def main() -> None:
    """Measure everything that can be measured here."""
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors")
    crowd = str(Path(__file__).with_name("crowd.py"))
    names: list[Any] = [*(["rosmaster"] if _ROSMASTER.exists() else []), "kg"]
    for name in names:
        port = _free_port()
        with _master(name, port):
            print(f"graph, master {name}:")
            with _running(port, sys.executable, crowd, f"http://127.0.0.1:{port}/", str(_NODES), str(_TOPICS)):
                asyncio.run(_analyze(port))
        if _ROSMASTER.exists():
            port = _free_port()
            with _master(name, port), _running(port, "/usr/bin/python3", "-c", _ECHO):
                print(f"{_RATE} Hz for {_SECONDS} s to rospy and back, master {name}:")
                asyncio.run(_echo(port))
