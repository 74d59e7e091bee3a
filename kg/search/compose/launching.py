"""The launch file of a chain: XML of roslaunch for ROS 1, Python for ROS 2, with comments on each node."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final
from xml.sax.saxutils import quoteattr

from kg.render.text import printable, some
from kg.search.compose.network import grouped

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.search.compose.details import Unset
    from kg.search.compose.results import Composed, Node
    from kg.search.compose.wiring import Link

_MOST: Final = 8  # how many inputs of a node are named one by one


def launch_text(chain: Composed) -> str:
    """Return the launch file of a chain: XML of roslaunch for ROS 1, Python for ROS 2."""
    return _roslaunch(chain) if chain.wiring.ros == 1 else _ros2_launch(chain)


def _roslaunch(chain: Composed) -> str:
    """Return XML of roslaunch (wiki.ros.org/roslaunch/XML)."""
    lines = ['<?xml version="1.0"?>', "<!--", *(f"  {_comment(line)}" for line in _heading(chain)), "-->", "<launch>"]
    for place in (0, -1):
        link = chain.wiring.links[place]
        default, doc = quoteattr(link.topic), quoteattr(_purpose(chain, place))
        lines.append(f"  <arg name={quoteattr(link.argument or '')} default={default} doc={doc}/>")
    if chain.wiring.host:
        host = quoteattr(chain.wiring.host)
        lines += ["", f'  <node pkg="nodelet" type="nodelet" name={host} args="manager" output="screen"/>']
    for place in range(len(chain.nodes)):
        lines += ["", *_node_element(chain, place)]
    return "\n".join([*lines, "</launch>", ""])


def _node_element(chain: Composed, place: int) -> Iterator[str]:
    node = chain.nodes[place]
    start, part = node.start, node.part
    for line in _remarks(chain, place):
        yield f"  <!-- {_comment(line)} -->"
    program = part.executable or "nodelet"
    package = part.package if part.executable else "nodelet"
    load = "" if part.executable else f" args={quoteattr(f'load {part.plugin} {chain.wiring.host}')}"
    what = f"pkg={quoteattr(package)} type={quoteattr(program)} name={quoteattr(start.name)}{load}"
    yield f'  <node {what} output="screen">'
    for own, link in start.remaps:
        name = f"~{own[2:]}" if own.startswith("~/") else own  # a private name in the syntax of ROS 1
        yield f"    <remap from={quoteattr(name)} to={quoteattr(_topic_in_xml(link))}/>"
    for name, link in start.topics:
        yield f"    <param name={quoteattr(_below(name))} value={quoteattr(_topic_in_xml(link))}/>"
    for name, value in start.switches.items():
        text = str(value).lower() if isinstance(value, bool) else str(value)
        yield f"    <param name={quoteattr(_below(name))} value={quoteattr(text)}/>"
    for one in _unset(chain, node):
        kind = f"{one.type}, " if one.type else ""
        parameter = printable(f'<param name={quoteattr(_below(one.name))} value=""/> {kind}{one.location}')
        yield f"    <!-- {_comment(parameter)} -->"
    yield "  </node>"


def _topic_in_xml(link: Link) -> str:
    return f"$(arg {link.argument})" if link.argument else link.topic


def _comment(text: str) -> str:
    """Return a text that is valid in an XML comment: without two adjacent hyphens or a final one."""
    while "--" in text:
        text = text.replace("--", "- -")
    return f"{text} " if text.endswith("-") else text


def _ros2_launch(chain: Composed) -> str:
    """Return Python (the packages `launch` and `launch_ros`)."""
    places = range(len(chain.nodes))
    loaded = [place for place in places if chain.nodes[place].start.loaded]
    started = [place for place in places if not chain.nodes[place].start.loaded]
    actions = [name for name, used in (("ComposableNodeContainer", loaded), ("Node", started)) if used]
    lines = [
        *(f"# {line}" for line in _heading(chain)),
        "",
        "from launch import LaunchDescription",
        "from launch.actions import DeclareLaunchArgument",
        "from launch.substitutions import LaunchConfiguration",
        f"from launch_ros.actions import {', '.join(actions)}",
        *(["from launch_ros.descriptions import ComposableNode"] if loaded else []),
        *("", "", "def generate_launch_description():", "    return LaunchDescription(["),
    ]
    for place in (0, -1):
        link = chain.wiring.links[place]
        arguments = f"{link.argument!r}, default_value={link.topic!r}, description={_purpose(chain, place)!r}"
        lines.append(f"        DeclareLaunchArgument({arguments}),")
    for place in started:
        lines += [f"        {line}" for line in _started(chain, place)]
    if loaded:
        lines += [f"        {line}" for line in _container(chain, loaded)]
    return "\n".join([*lines, "    ])", ""])


def _started(chain: Composed, place: int) -> Iterator[str]:
    node = chain.nodes[place]
    yield from (f"# {line}" for line in _remarks(chain, place))
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
        yield from (f"        # {line}" for line in _remarks(chain, place))
        yield "        ComposableNode("
        yield f"            package={node.part.package!r},"
        yield f"            plugin={node.part.plugin!r},"
        yield from (f"        {line}" for line in _settings(chain, node))
        yield "        ),"
    yield "    ],"
    yield "    output='screen',"
    yield "),"


def _settings(chain: Composed, node: Node) -> Iterator[str]:
    yield f"    name={node.start.name!r},"
    if node.start.remaps:
        pairs = ", ".join(f"({own!r}, {_topic_in_python(link)})" for own, link in node.start.remaps)
        yield f"    remappings=[{pairs}],"
    given = [(_below(name), _topic_in_python(link)) for name, link in node.start.topics]
    given += [(_below(name), repr(value)) for name, value in node.start.switches.items()]
    free = _unset(chain, node)
    if not given and not free:
        return
    yield "    parameters=[{"
    yield from (f"        {name!r}: {value}," for name, value in given)
    for one in free:
        kind = f"{one.type}, " if one.type else ""
        yield f"        # {_below(one.name)!r}: {printable(f'{kind}{one.location}')}"
    yield "    }],"


def _topic_in_python(link: Link) -> str:
    return f"LaunchConfiguration({link.argument!r})" if link.argument else repr(link.topic)


def _heading(chain: Composed) -> list[str]:
    nodes = (f"{place}. {node.part.full_name}, {node.part.repository}" for place, node in enumerate(chain.nodes, 1))
    return [printable(line) for line in (" -> ".join(chain.types), *nodes, "Written by `kg compose`.")]


def _purpose(chain: Composed, place: int) -> str:
    """Return the purpose of the argument for the first or last topic of a chain."""
    link = chain.wiring.links[place]
    return printable(f"{link.type} that the chain {'takes' if place == 0 else 'gives'}")


def _remarks(chain: Composed, place: int) -> list[str]:
    """Return remarks on a node of a chain, in lines: the places of its ends, and its other needs."""
    node, links = chain.nodes[place], chain.wiring.links
    start, part = node.start, node.part
    remarks = [
        f"{part.full_name}: {part.path}:{part.line}",
        f"takes {links[place].type} as {_own(start.taken.name)}: {chain.details.place(start.taken, part)}",
        f"gives {links[place + 1].type} as {_own(start.given.name)}: {chain.details.place(start.given, part)}",
    ]
    if part.iri in chain.details.lifecycle:
        remarks.append("It has a life cycle: configure and activate it before it does anything.")
    for verb, ports in (("also needs", node.needs), ("is also given", node.fed)):
        kinds = grouped(ports)
        remarks += [f"{verb} {kind}{_names(names)}" for kind, names in kinds[:_MOST]]
        if len(kinds) > _MOST:
            remarks.append(f"{verb} {len(kinds) - _MOST} more types")
    remarks += [f"note: {one}" for one in node.remarks]
    return [printable(line) for line in remarks]


def _unset(chain: Composed, node: Node) -> tuple[Unset, ...]:
    """Return the parameters without a known default that the launch file does not set either."""
    given = {*(name for name, _ in node.start.topics), *node.start.switches}
    unset = chain.details.unset.get(node.part.iri, ())
    return tuple(one for one in unset if one.name not in given)


def _own(name: str | None) -> str:
    return f"`{name}`" if name is not None else "a name that a parameter gives"


def _names(names: list[str]) -> str:
    return f" as {some(names, _MOST)}" if names else ""


def _below(name: str) -> str:
    """Return the name of a parameter relative to its node."""
    return name.removeprefix("~/")
