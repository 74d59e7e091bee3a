"""The launch file of a chain of ROS 1 nodes, in the XML of roslaunch (wiki.ros.org/roslaunch/XML)."""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

from kg.render.text import printable
from kg.search.compose.launching import heading, purpose, remarks, unset

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.search.compose.details import Unset
    from kg.search.compose.results import Composed
    from kg.search.compose.wiring import Link


def written(chain: Composed) -> str:
    """Return the launch file."""
    lines = ['<?xml version="1.0"?>', "<!--", *(f"  {_comment(line)}" for line in heading(chain)), "-->", "<launch>"]
    for place in (0, -1):
        link = chain.wiring.links[place]
        default, doc = quoteattr(link.topic), quoteattr(purpose(chain, place))
        lines.append(f"  <arg name={quoteattr(link.argument or '')} default={default} doc={doc}/>")
    if chain.wiring.host:
        host = quoteattr(chain.wiring.host)
        lines += ["", f'  <node pkg="nodelet" type="nodelet" name={host} args="manager" output="screen"/>']
    for place in range(len(chain.nodes)):
        lines += ["", *_node(chain, place)]
    return "\n".join([*lines, "</launch>", ""])


def _node(chain: Composed, place: int) -> Iterator[str]:
    node = chain.nodes[place]
    start, part = node.start, node.part
    for line in remarks(chain, place):
        yield f"  <!-- {_comment(line)} -->"
    program = part.executable or "nodelet"
    package = part.package if part.executable else "nodelet"
    load = "" if part.executable else f" args={quoteattr(f'load {part.plugin} {chain.wiring.host}')}"
    what = f"pkg={quoteattr(package)} type={quoteattr(program)} name={quoteattr(start.name)}{load}"
    yield f'  <node {what} output="screen">'
    for own, link in start.remaps:
        yield f"    <remap from={quoteattr(_private(own))} to={quoteattr(_topic(link))}/>"
    for name, link in start.topics:
        yield f"    <param name={quoteattr(_below(name))} value={quoteattr(_topic(link))}/>"
    for name, value in start.switches.items():
        text = str(value).lower() if isinstance(value, bool) else str(value)
        yield f"    <param name={quoteattr(_below(name))} value={quoteattr(text)}/>"
    for one in unset(chain, node):
        yield f"    <!-- {_comment(_settable(one))} -->"
    yield "  </node>"


def _settable(one: Unset) -> str:
    kind = f"{one.type}, " if one.type else ""
    return printable(f'<param name={quoteattr(_below(one.name))} value=""/> {kind}{one.location}')


def _topic(link: Link) -> str:
    return f"$(arg {link.argument})" if link.argument else link.topic


def _private(name: str) -> str:
    """Return a name in the syntax of ROS 1: `~name`."""
    return f"~{name[2:]}" if name.startswith("~/") else name


def _below(name: str) -> str:
    """Return the name of a parameter relative to its node."""
    return name.removeprefix("~/")


def _comment(text: str) -> str:
    """Return a text that is valid in an XML comment: without two adjacent hyphens or a final one."""
    while "--" in text:
        text = text.replace("--", "- -")
    return f"{text} " if text.endswith("-") else text
