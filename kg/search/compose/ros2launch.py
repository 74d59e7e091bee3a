"""The launch file of a chain of ROS 2 nodes, in Python (the packages `launch` and `launch_ros`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.render.text import printable
from kg.search.compose.launching import heading, purpose, remarks, unset

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.search.compose.results import Composed, Node
    from kg.search.compose.wiring import Link, Start


def written(chain: Composed) -> str:
    """Return the launch file."""
    places = range(len(chain.nodes))
    loaded = [place for place in places if chain.nodes[place].start.loaded]
    started = [place for place in places if not chain.nodes[place].start.loaded]
    lines = [f"# {line}" for line in heading(chain)]
    lines += ["", *_imports(started=bool(started), loaded=bool(loaded)), "", "", "def generate_launch_description():"]
    lines.append("    return LaunchDescription([")
    for place in (0, -1):
        link = chain.wiring.links[place]
        arguments = f"{link.argument!r}, default_value={link.topic!r}, description={purpose(chain, place)!r}"
        lines.append(f"        DeclareLaunchArgument({arguments}),")
    for place in started:
        lines += [f"        {line}" for line in _started(chain, place)]
    if loaded:
        lines += [f"        {line}" for line in _container(chain, loaded)]
    return "\n".join([*lines, "    ])", ""])


def _imports(*, started: bool, loaded: bool) -> Iterator[str]:
    yield "from launch import LaunchDescription"
    yield "from launch.actions import DeclareLaunchArgument"
    yield "from launch.substitutions import LaunchConfiguration"
    actions = ["ComposableNodeContainer"] * loaded + ["Node"] * started
    yield f"from launch_ros.actions import {', '.join(actions)}"
    if loaded:
        yield "from launch_ros.descriptions import ComposableNode"


def _started(chain: Composed, place: int) -> Iterator[str]:
    node = chain.nodes[place]
    yield from (f"# {line}" for line in remarks(chain, place))
    yield "Node("
    yield f"    package={node.part.package!r},"
    yield f"    executable={node.part.executable!r},"
    yield from _settings(chain, node)
    yield "    output='screen',"
    yield "),"


def _container(chain: Composed, places: list[int]) -> Iterator[str]:
    yield "ComposableNodeContainer("
    yield f"    name={chain.wiring.host!r},"
    yield "    namespace='',"
    yield "    package='rclcpp_components',"
    yield "    executable='component_container',"
    yield "    composable_node_descriptions=["
    for place in places:
        node = chain.nodes[place]
        yield from (f"        # {line}" for line in remarks(chain, place))
        yield "        ComposableNode("
        yield f"            package={node.part.package!r},"
        yield f"            plugin={node.part.plugin!r},"
        yield from (f"        {line}" for line in _settings(chain, node))
        yield "        ),"
    yield "    ],"
    yield "    output='screen',"
    yield "),"


def _settings(chain: Composed, node: Node) -> Iterator[str]:
    """Yield the settings common to nodes and components."""
    yield f"    name={node.start.name!r},"
    if node.start.remaps:
        pairs = ", ".join(f"({own!r}, {_topic(link)})" for own, link in node.start.remaps)
        yield f"    remappings=[{pairs}],"
    given = _parameters(node.start)
    free = unset(chain, node)
    if not given and not free:
        return
    yield "    parameters=[{"
    yield from (f"        {name!r}: {value}," for name, value in given)
    for one in free:
        kind = f"{one.type}, " if one.type else ""
        yield f"        # {_below(one.name)!r}: {printable(f'{kind}{one.location}')}"
    yield "    }],"


def _parameters(start: Start) -> list[tuple[str, str]]:
    topics = [(_below(name), _topic(link)) for name, link in start.topics]
    return [*topics, *((_below(name), repr(value)) for name, value in start.switches.items())]


def _topic(link: Link) -> str:
    return f"LaunchConfiguration({link.argument!r})" if link.argument else repr(link.topic)


def _below(name: str) -> str:
    return name.removeprefix("~/")
