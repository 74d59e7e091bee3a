"""Definitions of message types as texts: their lines, their MD5 sums in ROS 1, and common packages.

The text form is that of `.msg` files (wiki.ros.org/msg and the article on interfaces of ROS 2's documentation). A
publisher of ROS 1 sends several in one text, separated by lines of `=` followed by `MSG: package/Type`.

The common packages are files of `ontology/definitions`, read on demand. A file holds one package; a line `= msg Name`,
`= srv Name` or `= action Name` begins a definition. The messages of an action's topics and services are derived: in ROS
1 `NameActionGoal` and so on (wiki.ros.org/actionlib/DetailedDescription), in ROS 2 those of the two services and of
feedback (design.ros2.org/articles/actions.html).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from itertools import takewhile
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from rosbags.interfaces import Nodetype

from kg.resources import folder

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from rosbags.typesys.store import Typestore

_BASE: Final = frozenset(
    {"bool", "byte", "char", "float32", "float64", "string"}
    | {f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)}
)
_TIMES: Final = {"time": "builtin_interfaces/Time", "duration": "builtin_interfaces/Duration"}
_TYPE: Final = re.compile(r"[A-Za-z][A-Za-z0-9_]*/[A-Za-z][A-Za-z0-9_]*")
_CONSTANT: Final = re.compile(r"([a-z0-9]+)(?:<=\d+)?\s+([A-Za-z]\w*)\s*=\s*(.*)", re.ASCII)
_FIELD: Final = re.compile(
    r"((?:[A-Za-z]\w*/)?[A-Za-z]\w*)(?:<=(\d+))?(?:\[(<=)?(\d*)\])?\s+([A-Za-z]\w*)(?:\s+\S.*)?", re.ASCII
)
_SEPARATOR: Final = re.compile(r"^={20,}[ \t]*$", re.MULTILINE)
_MOST_CHARACTERS: Final = 1 << 18
_MOST_ELEMENTS: Final = 1 << 22


@dataclass(frozen=True, slots=True)
class Line:
    """A field: `type` is a base type or `package/Type`, `text` the part of the MD5 input for a base type.

    `length` is None for a single value, the number of elements of an array, or the maximum of a list, 0 for unlimited.
    """

    name: str
    type: str
    text: str
    length: int | None = None
    fixed: bool = False
    most_characters: int = 0

    @property
    def kind(self) -> Any:
        """The type in the notation of `rosbags`."""
        inner: Any = (
            (Nodetype.NAME, self.type.replace("/", "/msg/"))
            if "/" in self.type
            else (Nodetype.BASE, (self.type, self.most_characters))
        )
        if self.length is None:
            return inner
        return (Nodetype.ARRAY if self.fixed else Nodetype.SEQUENCE, (inner, self.length))


@dataclass(frozen=True, slots=True)
class Definition:
    """A message type: its fields, and its constants as texts of the MD5 input."""

    name: str
    constants: tuple[str, ...]
    fields: tuple[Line, ...]

    @property
    def text(self) -> str:
        """The definition without comments."""
        return "".join(f"{line}\n" for line in (*self.constants, *(field.text for field in self.fields)))


def is_type(name: str) -> bool:
    """Return whether a text is a valid name of a type: `package/Type`."""
    return _TYPE.fullmatch(name) is not None


def split(name: str, text: str) -> Iterator[tuple[str, str]]:
    """Yield the names and texts of the definitions sent by a publisher; ValueError for an invalid text."""
    if len(text) > _MOST_CHARACTERS:
        raise ValueError(f"it has {len(text)} characters, more than {_MOST_CHARACTERS}")
    first, *others = _SEPARATOR.split(text)
    yield name, first
    for other in others:
        heading, _, body = other.strip("\r\n").partition("\n")
        type_name = heading.removeprefix("MSG:").strip()
        if not heading.startswith("MSG:") or not is_type(type_name):
            raise ValueError(f"`{heading[:60]}` is not a heading of a definition")
        yield type_name, body


def read(name: str, text: str) -> Definition:
    """Return the definition in the lines of one message; ValueError with the invalid line."""
    constants: list[str] = []
    fields: list[Line] = []
    for raw in text.splitlines():
        line = raw.strip()
        if constant := _CONSTANT.fullmatch(line):
            kind, own, value = constant.groups()
            if kind not in _BASE:
                raise ValueError(f"a constant cannot be a `{kind}`")
            # The value of a text is all that follows, also a `#`.
            constants.append(f"{kind} {own}={(value if kind == 'string' else value.partition('#')[0]).strip()}")
        elif line := line.partition("#")[0].strip():
            fields.append(_field(name, line))
    names = [field.name for field in fields]
    if len(set(names)) < len(names):
        raise ValueError("two fields have the same name")
    return Definition(name, tuple(constants), tuple(fields))


def _field(owner: str, line: str) -> Line:
    match = _FIELD.fullmatch(line)
    if match is None:
        raise ValueError(f"`{line[:60]}` is not a field")
    kind, characters, bound, length, name = match.groups()
    if characters and kind != "string":
        raise ValueError(f"`{line[:60]}` is not a field")
    if length and int(length) > _MOST_ELEMENTS:
        raise ValueError(f"`{line[:60]}` has more elements than {_MOST_ELEMENTS}")
    shown = f"{kind}{f'<={characters}' if characters else ''}"
    shown += f"[{bound or ''}{length}]" if length is not None else ""
    return Line(
        name,
        _full(owner, kind),
        f"{shown} {name}",
        None if length is None else int(length or 0),
        bool(length) and not bound,
        int(characters or 0),
    )


def _full(owner: str, kind: str) -> str:
    if kind == "Header":
        return "std_msgs/Header"
    if kind in _TIMES or kind in _BASE:
        return _TIMES.get(kind, kind)
    return kind if "/" in kind else f"{owner.partition('/')[0]}/{kind}"


def sum_text(definition: Definition, sum_of: Callable[[str], str]) -> str:
    """Return the text whose MD5 sum ROS 1 peers compare: constants first, sums in place of message types.

    The rule is that of wiki.ros.org/ROS/Technical%20Overview, "Message serialization and msg MD5 sums".
    """
    shown = (
        field.text if "/" not in field.type or field.type in _TIMES.values() else f"{sum_of(field.type)} {field.name}"
        for field in definition.fields
    )
    return "\n".join((*definition.constants, *shown))


PARTS: Final = {"srv": ("_Request", "_Response"), "action": ("_Goal", "_Result", "_Feedback")}
"""Suffixes of the messages of services and actions, in the order of their definitions."""
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
    Raises ValueError if the text has another number of parts than its sort requires.
    """
    if sort == "msg":
        yield name, text
        return
    lines = iter(text.splitlines())
    count = 1 + sum(line.strip() == "---" for line in text.splitlines())
    texts = ["\n".join(takewhile(lambda line: line.strip() != "---", lines)) for _ in range(count)]
    if len(texts) != len(PARTS[sort]):
        raise ValueError(f"it has {len(texts)} parts, not {len(PARTS[sort])}")
    for suffix, part in zip(PARTS[sort], texts, strict=True):
        yield name + (suffix[1:] if sort == "action" and ros == 1 else suffix), part
    if sort == "action":
        yield from derived(name, ros)


def derived(name: str, ros: int) -> Iterator[tuple[str, str]]:
    """Yield the names and texts of the messages of an action's topics and services."""
    for suffix, text in _DERIVED[ros].items():
        yield name + suffix, text.format(name)


@cache
def library(ros: int) -> Mapping[str, str]:
    """Return the texts of all messages that come with kg by name, for ROS 1 or 2."""
    texts: dict[str, str] = {}
    for path in sorted((folder("ontology") / "definitions" / f"ros{ros}").glob("*.txt")):
        for section in path.read_text(encoding="utf-8").removeprefix("= ").split("\n= "):
            heading, _, text = section.partition("\n")
            sort, _, name = heading.partition(" ")
            texts |= parts(f"{path.stem}/{name}", sort, text, ros)
    return MappingProxyType(texts)


_MOST_PARTS: Final = 4096
_DEEPEST: Final = 32
_NUMBERS_OF_A_PART: Final = 1024


def check_size(store: Typestore, new: Mapping[str, Definition], resolve: Callable[[str], str]) -> None:
    """Raise ValueError for definitions whose values would exhaust memory; `resolve` returns the full name of a type.

    Lists of messages without fields are refused too: four bytes could declare billions of elements.
    """
    sizes: dict[str, int] = {}

    def of_message(name: str, within: tuple[str, ...]) -> int:
        """Return the minimum number of values of a message; arrays of numbers count as one."""
        if name in within or len(within) > _DEEPEST:
            raise ValueError(f"`{name}` contains itself" if name in within else "its messages are nested too deeply")
        if name not in sizes:
            own: list[Any] = [field.kind for field in new[name].fields] if name in new else []
            kinds = own if name in new else [kind for _, kind in store.fielddefs[resolve(name)][1]]
            sizes[name] = sum(of_field(kind, (*within, name)) for kind in kinds)
            if sizes[name] > _MOST_PARTS:
                raise ValueError(f"a `{name}` has more than {_MOST_PARTS} values")
        return sizes[name]

    def of_field(kind: Any, within: tuple[str, ...]) -> int:
        sort, inner = kind
        if sort is Nodetype.BASE:
            return 1
        if sort is Nodetype.NAME:
            return of_message(inner.replace("/msg/", "/"), within)
        element, length = inner
        each = of_field(element, within)
        if sort is Nodetype.SEQUENCE:
            if not each:
                raise ValueError(f"a list of `{element[1]}` has elements without content")
            return 1
        numbers = element[0] is Nodetype.BASE and element[1][0] != "string"
        return 1 + length // _NUMBERS_OF_A_PART if numbers else int(length * each)

    for name in new:
        of_message(name, ())
