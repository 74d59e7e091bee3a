"""Explain why no chain exists: types without subscriber or publisher, and the types reachable from either side."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.errors import UnknownNameError
from kg.render.text import count
from kg.search.compose.asking import Asked
from kg.search.compose.chains import Chain, Search, Step
from kg.search.compose.costs import generic
from kg.search.compose.steps import between, steps_of
from kg.similar import asked as asked_for
from kg.similar import similar

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kg.search.compose.network import Network

_SHOWN: Final = 6


def nothing(network: Network, asked: Asked, using: Sequence[str], ros: int | None, length: int) -> UnknownNameError:
    """Return the error KG706 for a request without result, with the types that can be reached."""
    sides = (", ".join(asked.starts), ", ".join(sorted(asked.goals)))
    through = f" through {', '.join(f'`{one}`' for one in using)}" if using else ""
    version = f" of ROS {ros}" if ros else ""
    message = f"no chain of at most {length} nodes{version} turns {sides[0]} into {sides[1]}{through}"
    lines = [*_missing(network, asked, ros)]
    for one in (1, 2):
        if ros in {None, one}:
            lines += _reached(network, asked, length, one)
    if using:
        lines.append("Without `--using` there may be one.")
    return UnknownNameError("KG706", message, hint="\n".join(lines) or "`kg topics` lists topics with their types.")


def _missing(network: Network, asked: Asked, ros: int | None) -> Iterator[str]:
    """Yield the types that no node subscribes to, or publishes."""
    parts = [part for part in network.parts if ros in {None, part.ros}]
    taken = {port.type for part in parts for port in part.inputs}
    given = {port.type for part in parts for port in part.outputs}
    for verb, wanted, known in (("subscribes", asked.starts, taken), ("publishes", sorted(asked.goals), given)):
        for name in wanted:
            if name not in known:
                last = {one.rpartition("/")[2]: one for one in sorted(known, reverse=True)}
                near = asked_for([last[one] for one in similar(name.rpartition("/")[2], last)])
                version = f" of ROS {ros}" if ros else ""
                yield f"No node{version} that can be started {verb} {name}.{f' {near}' if near else ''}"


def _reached(network: Network, asked: Asked, length: int, ros: int) -> Iterator[str]:
    """Yield the types reachable from the starts, with the longest path, and those that lead to the goals."""
    steps = steps_of(network, Asked(asked.starts, asked.goals), ros)
    forwards = _levels(steps, asked.starts, length)
    reached = {name: level for name, level in forwards.items() if level}
    if reached:
        farthest = max(sorted(reached), key=lambda name: reached[name])
        yield f"ROS {ros}: {', '.join(asked.starts)} becomes {_some(reached)}."
        search = Search(steps, asked.starts, frozenset({farthest}), length, between(network))
        chain = next(search.best(), None)
        if chain is not None:
            yield f"ROS {ros}: the longest way goes {_way(network, chain)}."
    back: dict[str, list[Step]] = {}
    for found in steps.values():
        for step in found:
            back.setdefault(step.target, []).append(step)
    before = _levels(back, sorted(asked.goals), length, backwards=True)
    sources = {name: level for name, level in before.items() if level}
    if sources:
        yield f"ROS {ros}: {', '.join(sorted(asked.goals))} is made of {_some(sources)}."


def _levels(
    steps: Mapping[str, Sequence[Step]], starts: Iterable[str], length: int, *, backwards: bool = False
) -> dict[str, int]:
    """Return the reachable types that are not generic, with the least number of nodes for each."""
    found = dict.fromkeys(starts, 0)
    edge = list(found)
    for level in range(1, length + 1):
        reached = [step.source if backwards else step.target for name in edge for step in steps.get(name, ())]
        edge = [name for name in dict.fromkeys(sorted(reached)) if name not in found and not generic(name)]
        found.update(dict.fromkeys(edge, level))
    return found


def _some(levels: Mapping[str, int]) -> str:
    names = sorted(levels, key=lambda name: (levels[name], name))
    more = f" and {count(len(names) - _SHOWN, 'more type')}" if len(names) > _SHOWN else ""
    return ", ".join(names[:_SHOWN]) + more


def _way(network: Network, chain: Chain) -> str:
    nodes = (f"{network.parts[step.part].full_name} -> {step.target}" for step in chain.steps)
    return " -> ".join((chain.steps[0].source, *nodes))
