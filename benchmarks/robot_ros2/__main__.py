"""How fast a node of ours is over DDS and Zenoh; see README.md.

python benchmarks/robot_ros2 [dds|zenoh]
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import socket
import statistics
import subprocess
import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from kg.robot.connecting import connect

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kg.robot.connection import Connection, Subscription

RATE = 100.0
SECONDS = 10
NODES = 500
TOPICS = 2000
PARTICIPANTS = 10
DDS = (
    "<CycloneDDS><Domain><General><AllowMulticast>false</AllowMulticast>"
    "<Interfaces><NetworkInterface name='lo' multicast='false'/></Interfaces></General>"
    "<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>30</MaxAutoParticipantIndex>"
    "<Peers><Peer address='127.0.0.1'/></Peers></Discovery></Domain></CycloneDDS>"
)


def main() -> None:
    """Measure what is asked for, or both."""
    if sys.argv[1:2] == ["peer"]:
        _PEERS[sys.argv[2]](sys.argv[3])
        return
    os.environ["CYCLONEDDS_URI"] = DDS
    parser = argparse.ArgumentParser(prog="robot_ros2", description=main.__doc__)
    parser.add_argument(
        "schemes", nargs="*", choices=["dds", "zenoh"], default=["dds", "zenoh"], help="what to measure"
    )
    for scheme in parser.parse_args().schemes or ["dds", "zenoh"]:
        figures = asyncio.run(_echoes(scheme)) | asyncio.run(_discovered(scheme))
        print(scheme, json.dumps(figures), flush=True)


@contextmanager
def _beside(role: str, place: str) -> Iterator[None]:
    command = [sys.executable, __file__, "peer", role, place]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as peer:
        if peer.stdout is None or peer.stdout.readline() != "ready\n":
            raise SystemExit(f"the peer {role} did not start")
        try:
            yield
        finally:
            peer.kill()


def _place(scheme: str) -> str:
    if scheme == "dds":
        return f"dds://{os.getpid() % 230}?settle=1"
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return f"zenoh://127.0.0.1:{one.getsockname()[1]}?settle=1"


async def _echoes(scheme: str) -> dict[str, float]:
    """Send commands at 100 Hz to a node in another process that sends each back, and as fast as it goes."""
    place = _place(scheme)
    with _beside(f"{scheme}-hub" if scheme == "zenoh" else "nobody", place), _beside("echo", place):
        connection = await connect(place)
        answers = await connection.subscribe("/echo", "geometry_msgs/Twist", queue=100_000)
        commands = await connection.advertise("/cmd_vel", "geometry_msgs/Twist")
        async for graph in connection.changes():
            if commands.peers and any(end.name == "/echo" for end in graph.ends):
                break
        before, began = time.process_time(), time.perf_counter()
        reading = asyncio.ensure_future(_read(answers, int(RATE * SECONDS)))
        for number in range(int(RATE * SECONDS)):
            await asyncio.sleep(max(0.0, began + number / RATE - time.perf_counter()))
            await commands.publish({"linear": {"x": time.perf_counter()}})
        delays = await asyncio.wait_for(reading, 30)
        used = time.process_time() - before
        began = time.perf_counter()
        reading = asyncio.ensure_future(_read(answers, 5000))
        for number in range(5000):
            await commands.publish({"linear": {"x": float(number)}})
            if number % 50 == 0:
                await asyncio.sleep(0.001)
        came = len(await asyncio.wait_for(reading, 60))
        fast = came / (time.perf_counter() - began)
        await connection.aclose()
    return {
        "sent": RATE * SECONDS,
        "came back": len(delays),
        "median ms": round(1000 * statistics.median(delays), 2),
        "95th percentile ms": round(1000 * statistics.quantiles(delays, n=20)[-1], 2),
        "processor %": round(100 * used / SECONDS, 1),
        "most per second, there and back": round(fast),
    }


async def _read(answers: Subscription, number: int) -> list[float]:
    delays: list[float] = []
    async for one in answers:
        delays.append(time.perf_counter() - one.value["linear"]["x"])
        if len(delays) == number:
            break
    return delays


async def _discovered(scheme: str) -> dict[str, float]:
    """Join a system of 500 nodes and 2,000 topics, and wait until all of it is in the graph."""
    place = _place(scheme)
    with _beside(f"{scheme}-many", place):
        began = time.perf_counter()
        connection = await connect(place)
        async for graph in connection.changes():
            if len(graph.nodes) == NODES and len(graph.ends) == TOPICS:
                break
        seconds = time.perf_counter() - began
        await connection.aclose()
    return {"nodes": NODES, "topics": TOPICS, "seconds until all are known": round(seconds, 2)}


def _told() -> None:
    sys.stdout.write("ready\n")
    sys.stdout.flush()


def _echo(place: str) -> None:
    async def work(connection: Connection) -> None:
        commands = await connection.subscribe("/cmd_vel", "geometry_msgs/Twist", queue=100_000)
        answers = await connection.advertise("/echo", "geometry_msgs/Twist")
        _told()
        async for one in commands:
            await answers.publish(one.value)

    async def run() -> None:
        await work(await connect(place, name="/echo"))

    asyncio.run(run())


def _nobody(_: str) -> None:
    _told()
    sys.stdin.read()


def _hub(place: str) -> None:
    with _session(place):
        _told()
        sys.stdin.read()


def _session(place: str) -> Any:
    import zenoh  # noqa: PLC0415 - the one of two middlewares that is measured

    config = zenoh.Config()
    where = f"tcp/{place.removeprefix('zenoh://').partition('?')[0]}"
    for key, value in {"mode": "peer", "listen/endpoints": [where], "scouting/multicast/enabled": False}.items():
        config.insert_json5(key, json.dumps(value))
    return zenoh.open(config)


def _many_zenoh(place: str) -> None:
    with _session(place) as session:
        liveliness = session.liveliness()
        digest = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
        start = f"@ros2_lv/0/{session.zid()}"
        tokens = [liveliness.declare_token(f"{start}/{node}/0/NN/%/%/node{node}") for node in range(NODES)]
        tokens += [
            liveliness.declare_token(
                f"{start}/{topic % NODES}/{topic}/MP/%/%/node{topic % NODES}/%topic{topic}/"
                f"std_msgs::msg::dds_::String_/{digest}/1:2:1,10:,:,:,,"
            )
            for topic in range(TOPICS)
        ]
        _told()
        sys.stdin.read()
        del tokens


def _many_dds(place: str) -> None:
    from cyclonedds.core import Policy, Qos  # noqa: PLC0415 - the one of two middlewares that is measured
    from cyclonedds.domain import DomainParticipant  # noqa: PLC0415 - see above
    from cyclonedds.pub import DataWriter  # noqa: PLC0415 - see above
    from cyclonedds.topic import Topic  # noqa: PLC0415 - see above

    from kg.robot.dds.types import Classes  # noqa: PLC0415 - see above
    from kg.robot.messages import Types  # noqa: PLC0415 - see above

    types = Types(2)
    classes = Classes(types)
    info, text = classes.of("rmw_dds_common/ParticipantEntitiesInfo"), classes.of("std_msgs/String")
    reliable = Policy.Reliability.Reliable(100_000_000)
    kept: list[Any] = []
    for group in range(PARTICIPANTS):
        participant = DomainParticipant(int(place.removeprefix("dds://").partition("?")[0]))
        qos = Qos(reliable, Policy.Durability.TransientLocal, Policy.History.KeepLast(1))
        teller = DataWriter(participant, Topic(participant, "ros_discovery_info", info), qos=qos)
        nodes: list[dict[str, Any]] = []
        for node in range(group, NODES, PARTICIPANTS):
            writers = [
                DataWriter(participant, Topic(participant, f"rt/topic{topic}", text), qos=Qos(reliable))
                for topic in range(node, TOPICS, NODES)
            ]
            gids = [{"data": one.guid.bytes} for one in writers]
            nodes.append({"node_namespace": "/", "node_name": f"node{node}", "writer_gid_seq": gids})
            kept.append(writers)
        value = {"gid": {"data": participant.guid.bytes}, "node_entities_info_seq": nodes}
        from cyclonedds import _clayer  # noqa: PLC0415 - see above

        content = types.encode("rmw_dds_common/ParticipantEntitiesInfo", value)
        _clayer.ddspy_write(teller._ref, content.ljust(-(-len(content) // 4) * 4, b"\0"))  # noqa: SLF001 - no public way to bytes
        kept.append([participant, teller])
    _told()
    sys.stdin.read()


_PEERS: dict[str, Callable[[str], None]] = {
    "echo": _echo,
    "nobody": _nobody,
    "zenoh-hub": _hub,
    "zenoh-many": _many_zenoh,
    "dds-many": _many_dds,
}

if __name__ == "__main__":
    main()
