"""How well capabilities are read and done at 100 Hz, both at a time: in memory, over TCP, with a node of rospy.

python -m benchmarks.driving [--seconds S] [--rate HZ]
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import socket
import subprocess
import sys
import tempfile
import time
from contextlib import AsyncExitStack, ExitStack, contextmanager
from itertools import pairwise
from pathlib import Path
from statistics import quantiles
from typing import TYPE_CHECKING, Any, Final

from kg.robot.capability import Capabilities, Capability, Parameter, Way
from kg.robot.connecting import connect
from kg.robot.driving import Driver
from kg.robot.memory import Bus
from kg.robot.ros1 import Master

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.connection import Connection

_ROSMASTER: Final = Path("/usr/bin/rosmaster")
_PEER: Final = """
import json, rospy, sys, time
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
rospy.init_node("peer", disable_signals=True)
came = []
rospy.Subscriber("/cmd_vel", Twist, lambda twist: came.append(time.time()), queue_size=1000, tcp_nodelay=True)
where, sender = Odometry(), rospy.Publisher("/odom", Odometry, queue_size=100, tcp_nodelay=True)
def tell(_):
    where.header.stamp = rospy.Time.now()
    sender.publish(where)
rospy.Timer(rospy.Duration(1 / float(sys.argv[1])), tell)
print("ready", flush=True)
sys.stdin.readline()
print(json.dumps(came), flush=True)
sys.stdin.read()
"""


def capabilities(rate: float) -> Capabilities:
    """Return a movement that is renewed at a rate, and a place that tells when it was measured."""
    topic: dict[str, Any] = {"kind": "topic", "node": "/peer"}
    speed = Parameter(name="forward", label="forward", unit="m/s", default=0.0, minimum=-1, maximum=1)
    drive = Way(**topic, name="/cmd_vel", type="geometry_msgs/Twist", fields={"forward": "linear.x"}, rate=rate)
    fields = {"s": "header.stamp.sec", "ns": "header.stamp.nanosec", "heading": "yaw(pose.pose.orientation)"}
    told = tuple(Parameter(name=name, label=name) for name in fields)
    where = Way(**topic, name="/odom", type="nav_msgs/Odometry", fields=fields)
    return Capabilities(
        of="the benchmark",
        capabilities=(
            Capability(iri="#d", name="drive", label="d", modality="write", parameters=(speed,), ways=(drive,)),
            Capability(iri="#w", name="where", label="w", modality="read", parameters=told, ways=(where,)),
        ),
    )


def main() -> None:
    """Measure, and write one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--rate", type=float, default=100)
    given = parser.parse_args()
    found: dict[str, Any] = {
        "memory": asyncio.run(_own("memory", given.seconds, given.rate)),
        "tcp": asyncio.run(_own("tcp", given.seconds, given.rate)),
    }
    if _ROSMASTER.exists():
        with _rosmaster() as port:
            found["rospy"] = asyncio.run(_rospy(port, given.seconds, given.rate))
    found["load"] = round(os.getloadavg()[0], 1)
    json.dump(found, sys.stdout, indent=2)
    sys.stdout.write("\n")


async def _own(over: str, seconds: float, rate: float) -> dict[str, Any]:
    """Measure with a peer of our own in this process."""
    async with AsyncExitStack() as stack:
        if over == "memory":
            address = stack.enter_context(Bus("benchmark")).address
        else:
            address = (await stack.enter_async_context(Master())).address
        peer, face = await connect(address, name="/peer"), await connect(address, name="/face")
        stack.push_async_callback(peer.aclose)
        stack.push_async_callback(face.aclose)
        came: list[float] = []
        tasks = [asyncio.ensure_future(_take(peer, came)), asyncio.ensure_future(_tell(peer, rate))]
        measured = await _measure(face, seconds, rate)
        for task in tasks:
            task.cancel()
        return {**measured, "most_a_second": await _most(peer, face), **_gaps("done", came)}


async def _take(peer: Connection, came: list[float]) -> None:
    commands = aiter(await peer.subscribe("/cmd_vel", "geometry_msgs/Twist", queue=1000))
    while True:
        await anext(commands)
        came.append(time.time())


async def _tell(peer: Connection, rate: float) -> None:
    sender, due = await peer.advertise("/odom", "nav_msgs/Odometry"), time.monotonic()
    while True:
        await sender.publish({"header": {"stamp": _stamp(time.time())}})
        due += 1 / rate
        await asyncio.sleep(max(0, due - time.monotonic()))


def _stamp(now: float) -> dict[str, int]:
    return {"sec": int(now), "nanosec": int(now % 1 * 1e9)}


async def _measure(face: Connection, seconds: float, rate: float) -> dict[str, Any]:
    """Read and do at a time; return how much, how late values are, and the part of a processor that it takes."""
    late: list[float] = []
    at: list[float] = []

    async def read(driver: Driver) -> None:
        async for value in driver.read("where"):
            at.append(time.time())
            late.append(at[-1] - value["s"] - value["ns"] / 1e9)

    async with Driver(face, capabilities(rate), limit=10 * rate) as driver:
        reading = asyncio.ensure_future(read(driver))
        await driver.do("drive", {"forward": 0.1}, seconds=1)
        late.clear()
        at.clear()
        begun, cpu = time.monotonic(), time.process_time()
        outcome = await driver.do("drive", {"forward": 0.1}, seconds=seconds)
        took, cpu = time.monotonic() - begun, time.process_time() - cpu
        reading.cancel()
        await asyncio.gather(reading, return_exceptions=True)
    return {
        "processor": round(cpu / took, 3),
        "done_a_second": round(outcome.sent / took, 1),
        "read_a_second": round(len(at) / took, 1),
        "read_late_ms": {"median": _ms(late, 50), "p99": _ms(late, 99)},
        **_gaps("read", at),
    }


async def _most(peer: Connection, face: Connection, number: int = 3000) -> float:
    """Return how many values a second are read when the peer sends as fast as it can, in pieces that fit a queue."""
    async with Driver(face, capabilities(100)) as driver:
        sender, values = await peer.advertise("/odom", "nav_msgs/Odometry"), driver.read("where")
        first = asyncio.ensure_future(anext(values))
        while not first.done():
            await sender.publish({})
            await asyncio.sleep(0.01)
        begun = time.monotonic()
        for _ in range(number // 50):
            for _ in range(50):
                await sender.publish({})
            for _ in range(50):
                await anext(values)
        took = time.monotonic() - begun
        await values.aclose()
    return round(number / took)


@contextmanager
def _rosmaster() -> Iterator[int]:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = int(probe.getsockname()[1])
    with ExitStack() as stack:
        home = stack.enter_context(tempfile.TemporaryDirectory())
        master = stack.enter_context(
            subprocess.Popen([_ROSMASTER, "--core", "-p", str(port)], env=_environment(port, home), stdout=-3)
        )
        stack.callback(master.terminate)
        time.sleep(2)
        yield port


def _environment(port: int, home: str) -> dict[str, str]:
    address = {"ROS_IP": "127.0.0.1", "ROS_MASTER_URI": f"http://127.0.0.1:{port}"}
    return {"PATH": "/usr/bin:/bin", "HOME": home, "LC_ALL": "C.UTF-8", **address}


async def _rospy(port: int, seconds: float, rate: float) -> dict[str, Any]:
    """Measure with a node of rospy in a process of its own."""
    with tempfile.TemporaryDirectory() as home:
        peer = await asyncio.create_subprocess_exec(
            *("/usr/bin/python3", "-c", _PEER, str(rate)),
            env=_environment(port, home),
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            limit=1 << 24,
        )
        assert peer.stdout is not None  # noqa: S101 - as it was started
        assert peer.stdin is not None  # noqa: S101 - as it was started
        await peer.stdout.readline()
        face = await connect(f"ros1://127.0.0.1:{port}", name="/face")
        measured = await _measure(face, seconds, rate)
        peer.stdin.write(b"\n")
        came: list[float] = json.loads(await peer.stdout.readline())
        await face.aclose()
        peer.kill()
        await peer.wait()
    return {**measured, **_gaps("done", came)}


def _gaps(name: str, at: list[float]) -> dict[str, Any]:
    gaps = [after - before for before, after in pairwise(at)]
    return {f"{name}_gap_ms": {"median": _ms(gaps, 50), "p99": _ms(gaps, 99), "longest": round(max(gaps) * 1e3, 1)}}


def _ms(values: list[float], percent: int) -> float:
    return round(quantiles(values, n=100)[percent - 1] * 1e3, 2)


if __name__ == "__main__":
    main()
