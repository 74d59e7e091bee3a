"""The definitions of common packages that come with `kg`: files of `ontology/definitions`, read when they are needed.

A file holds one package; a line `= msg Name`, `= srv Name` or `= action Name` begins a definition. Of an action the
messages are derived that its topics and services carry: in ROS 1 `NameActionGoal` and its like
(wiki.ros.org/actionlib/DetailedDescription), in ROS 2 those of the two services and the topic of feedback
(design.ros2.org/articles/actions.html).
"""

from __future__ import annotations

from functools import cache
from itertools import takewhile
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from kg.resources import folder

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

__all__ = ["derived", "library", "parts"]

_PARTS: Final = {"srv": ("_Request", "_Response"), "action": ("_Goal", "_Result", "_Feedback")}
_DERIVED: Final[dict[int, dict[str, str]]] = {
    1: {
        "ActionGoal": "std_msgs/Header header\nactionlib_msgs/GoalID goal_id\n{0}Goal goal\n",
        "ActionResult": "std_msgs/Header header\nactionlib_msgs/GoalStatus status\n{0}Result result\n",
        "ActionFeedback": "std_msgs/Header header\nactionlib_msgs/GoalStatus status\n{0}Feedback feedback\n",
        "Action": "{0}ActionGoal action_goal\n{0}ActionResult action_result\n{0}ActionFeedback action_feedback\n",
    },
    2: {
        "_SendGoal_Request": "unique_identifier_msgs/UUID goal_id\n{0}_Goal goal\n",
        "_SendGoal_Response": "bool accepted\nbuiltin_interfaces/Time stamp\n",
        "_GetResult_Request": "unique_identifier_msgs/UUID goal_id\n",
        "_GetResult_Response": "int8 status\n{0}_Result result\n",
        "_FeedbackMessage": "unique_identifier_msgs/UUID goal_id\n{0}_Feedback feedback\n",
    },
}


def parts(name: str, sort: str, text: str, ros: int) -> Iterator[tuple[str, str]]:
    """Yield the names and texts of the messages of a definition; `sort` is `msg`, `srv` or `action`.

    In ROS 1 the goal of an action `package/Name` is the message `package/NameGoal`, elsewhere `package/Name_Goal`.
    Raises ValueError where the text has not as many parts as its sort asks for.
    """
    if sort == "msg":
        yield name, text
        return
    texts = _cut(text)
    if len(texts) != len(_PARTS[sort]):
        raise ValueError(f"it has {len(texts)} parts, not {len(_PARTS[sort])}")
    for suffix, part in zip(_PARTS[sort], texts, strict=True):
        yield name + (suffix[1:] if sort == "action" and ros == 1 else suffix), part
    if sort == "action":
        yield from derived(name, ros)


def derived(name: str, ros: int) -> Iterator[tuple[str, str]]:
    """Yield the names and texts of what the topics and services of an action carry."""
    for suffix, text in _DERIVED[ros].items():
        yield name + suffix, text.format(name)


def _cut(text: str) -> list[str]:
    lines = iter(text.splitlines())
    count = 1 + sum(line.strip() == "---" for line in text.splitlines())
    return ["\n".join(takewhile(lambda line: line.strip() != "---", lines)) for _ in range(count)]


@cache
def library(ros: int) -> tuple[Mapping[str, str], Mapping[str, str]]:
    """Return the texts of all messages by name, and the sort (`srv`, `action`) of what is none, for ROS 1 or 2."""
    texts: dict[str, str] = {}
    sorts: dict[str, str] = {}
    for path in sorted((folder("ontology") / "definitions" / f"ros{ros}").glob("*.txt")):
        for section in path.read_text(encoding="utf-8").removeprefix("= ").split("\n= "):
            heading, _, text = section.partition("\n")
            sort, _, name = heading.partition(" ")
            full = f"{path.stem}/{name}"
            texts |= parts(full, sort, text, ros)
            if sort != "msg":
                sorts[full] = sort
    return MappingProxyType(texts), MappingProxyType(sorts)
