"""How long it takes until it is known what a running system can do: from its graph in memory, and in a store.

python -m benchmarks.live [--nodes N] [--topics N] [--repeat N]
"""

from __future__ import annotations

import argparse
import json
import random
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Final

from kg.facts import Role
from kg.robot.connection import ComputationGraph, LiveEnd, LiveNode
from kg.robot.live import infer
from kg.robot.live.keeping import Keeper
from kg.settings import load
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Callable

_TYPES: Final = (
    "geometry_msgs/Twist",
    "nav_msgs/Odometry",
    "sensor_msgs/Image",
    "sensor_msgs/LaserScan",
    "std_msgs/Bool",
    "std_msgs/Empty",
    "std_msgs/String",
    "tf2_msgs/TFMessage",
)
_ADDRESS: Final = "ros1://localhost:11311"


def main() -> None:
    """Measure, and write one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--nodes", type=int, default=500)
    parser.add_argument("--topics", type=int, default=2000)
    parser.add_argument("--repeat", type=int, default=5)
    given = parser.parse_args()
    found = {}
    for name, nodes, topics in (("robot", 12, 30), ("large", given.nodes, given.topics)):
        graph = made(nodes, topics)
        found[name] = {"nodes": nodes, "topics": topics, "ends": len(graph.ends), **measured(graph, given.repeat)}
    json.dump(found, sys.stdout, indent=2)
    sys.stdout.write("\n")


def made(nodes: int, topics: int) -> ComputationGraph:
    """Return a graph of so many nodes and topics, the same each time, with what ROS makes of every node."""
    chance = random.Random(1)  # noqa: S311 - a sample, no secret
    names = [f"/node{number}" for number in range(nodes)]
    ends = [
        LiveEnd(
            chance.choice(names), role, f"/topic{number}", chance.choice(_TYPES) if role is Role.PUBLISHES else None
        )
        for number in range(topics)
        for role in (Role.PUBLISHES, Role.SUBSCRIBES)
    ]
    kinds = {end.name: end.type for end in ends if end.type}
    ends = [replace(end, type=kinds[end.name]) for end in ends]
    for name in names:
        ends.append(LiveEnd(name, Role.PUBLISHES, "/rosout", "rosgraph_msgs/Log"))
        ends.append(LiveEnd(name, Role.SERVICES, f"{name}/get_loggers", "roscpp/GetLoggers"))
        ends.append(LiveEnd(name, Role.SERVICES, f"{name}/set_logger_level", "roscpp/SetLoggerLevel"))
    return ComputationGraph(1, tuple(LiveNode(name) for name in names), tuple(dict.fromkeys(ends)))


def measured(graph: ComputationGraph, repeat: int) -> dict[str, dict[str, float]]:
    """Return times: inference in memory, the first and later; a store made of nothing; a node that goes and comes."""
    settings = load({}, environment={})
    last = graph.nodes[-1].name
    less = replace(graph, nodes=graph.nodes[:-1], ends=tuple(end for end in graph.ends if end.node != last))
    found = {"infer_first": [_spent(lambda: infer(graph, settings, address=_ADDRESS))]}
    found["infer"] = [_spent(lambda: infer(graph, settings, address=_ADDRESS)) for _ in range(repeat)]
    with tempfile.TemporaryDirectory() as folder:
        keeper = Keeper(EmbeddedStore.create(Path(folder) / ".kg"), settings, address=_ADDRESS, name="benchmark")
        found["store_first"] = [_spent(lambda: keeper.keep(graph))]
        keeper.keep(less)
        keeper.keep(graph)
        pairs = [(_spent(lambda: keeper.keep(less)), _spent(lambda: keeper.keep(graph))) for _ in range(repeat)]
    found["store_node_went"] = [went for went, _ in pairs]
    found["store_node_came"] = [came for _, came in pairs]
    return {name: _medians(spent) for name, spent in found.items()}


def _spent(work: Callable[[], object]) -> tuple[float, float]:
    """Return the wall and the processor time of something."""
    began = time.perf_counter(), time.process_time()
    work()
    return time.perf_counter() - began[0], time.process_time() - began[1]


def _medians(spent: list[tuple[float, float]]) -> dict[str, float]:
    wall, processor = zip(*spent, strict=True)
    return {"wall": round(median(wall), 3), "processor": round(median(processor), 3)}


if __name__ == "__main__":
    main()
