"""`kg compose`: chains of nodes that turn one type of messages into another, and the launch files that wire them."""

from collections.abc import Iterator
from typing import Annotated, Final

from kg.cli.completion import features, nodes
from kg.cli.diagnostics import note
from kg.cli.options import Json, option, whole, with_settings
from kg.cli.output import json_lines, terminal, write
from kg.errors import UsageError
from kg.lazily import lazily
from kg.render.text import count, printable, some
from kg.settings import Settings
from kg.store.opening import existing

with lazily():
    from kg.search.compose import Question
    from kg.search.compose import compose as composed
    from kg.search.compose.launching import launch_text
    from kg.search.compose.network import grouped
    from kg.search.compose.results import Composed, Node, composed_object

_LONGEST: Final = 6
_MOST: Final = 4  # maximum number of copies and required types that are listed
From = Annotated[
    list[str],
    option(
        "--from TYPE",
        "Input type: `package/Type` or `Type`. If repeated, the first node subscribes to one of them.",
        autocompletion=features("subscribes"),
    ),
]
To = Annotated[
    list[str],
    option(
        "--to TYPE",
        "Output type. If repeated, the last node publishes one of them.",
        autocompletion=features("publishes"),
    ),
]
Using = Annotated[
    list[str] | None,
    option(
        "--using NAME",
        "Only chains through this: a node, a package, a type, or a keyword of a node.",
        autocompletion=nodes,
    ),
]
Ros = Annotated[str | None, option("--ros 1|2", "Only this version of ROS.")]
Length = Annotated[
    str | None, option("--length N", "Maximum number of nodes. [default: 4, and at most one more than the best chain]")
]
Most = Annotated[str, option("--limit -n N", "Number of chains to show.")]
Launch = Annotated[str | None, option("--launch RANK", "Write the launch file of the chain with this rank instead.")]


@with_settings("store")
def compose(  # noqa: PLR0913 - the options of a command
    *,
    settings: Settings,
    source: From,
    target: To,
    using: Using = None,
    ros: Ros = None,
    length: Length = None,
    limit: Most = "5",
    launch: Launch = None,
    json: Json = False,
) -> None:
    """Find chains of nodes that convert one message type into another.

    Each node subscribes to the type that the previous one publishes. Shorter chains come first. Among equals, nodes
    started by launch files, alone and together, and chains without further inputs come first; tests, demos and tools
    that only relay messages come last. `--launch RANK` writes the launch file that wires a chain: XML for ROS 1,
    Python for ROS 2. For example:

        kg compose --from LaserScan --to Twist
        kg compose --from sensor_msgs/Image --to sensor_msgs/PointCloud2 --using stereo
        kg compose --from LaserScan --to Twist --ros 1 --launch 1 > laserscan_to_twist.launch
    """
    rank = whole(launch, "--launch", 1) if launch is not None else 0
    question = Question(
        tuple(source),
        tuple(target),
        tuple(using or ()),
        whole(ros, "--ros", 1, 2) if ros is not None else None,
        whole(length, "--length", 1, _LONGEST) if length is not None else None,
        max(whole(limit, "--limit", 1), rank),
    )
    opened = existing(settings)
    with opened.read() as snapshot:
        answer = composed(snapshot, question, opened.layout.cache)
    for one in answer.request.notes:
        note(one)
    if rank:
        chain = next(iter(answer.chains[rank - 1 :]), None)
        if chain is None:
            hint = "Omit `--launch` to list the chains with their ranks."
            raise UsageError("KG003", f"no chain {rank}, only {count(len(answer.chains), 'chain')}", hint=hint)
        write(launch_text(chain).removesuffix("\n"))
        if terminal():
            note(f"save it with `--launch {rank} > {chain.file_name}`")
        return
    if json:
        json_lines(composed_object(chain, number) for number, chain in enumerate(answer.chains, 1))
    else:
        for number, chain in enumerate(answer.chains, 1):
            write("\n".join(["", *_chain_lines(chain, number)] if number > 1 else _chain_lines(chain, number)))
    if answer.more and (terminal() or json):
        note(f"the best {count(len(answer.chains), 'chain')}; --limit shows more")
    if answer.cut_off:
        note("the search stopped early: too many chains; narrow it with --using or a shorter --length")


def _chain_lines(chain: "Composed", rank: int) -> "Iterator[str]":
    yield f"{rank}. {' -> '.join(chain.types)}"
    for node in chain.nodes:
        yield from (f"   {printable(line)}" for line in _node_lines(chain, node))
    yield f"   {printable('; '.join(chain.reasons))}"


def _node_lines(chain: "Composed", node: "Node") -> "Iterator[str]":
    part, start = node.part, node.start
    yield f"{part.full_name}  {part.kind}, {part.repository}"
    for verb, port in (("takes", start.taken), ("gives", start.given)):
        name = f"`{port.name}`" if port.name is not None else f"what `{port.parameter}` names"
        yield f"  {verb} {name} {port.type}  {chain.details.place(port, part)}"
    needed = [f"{kind} ({', '.join(names[:_MOST])})" if names else kind for kind, names in grouped(node.needs)]
    if needed:
        yield f"  also needs {some(needed, _MOST)}"
    if node.fed:
        yield f"  also gets {some([kind for kind, _ in grouped(node.fed)], _MOST)} from before"
    if node.remarks:
        yield f"  {'; '.join(node.remarks)}"
    if node.others:
        yield f"  also as {some([f'{one.repository}:{one.full_name}' for one in node.others], _MOST)}"
