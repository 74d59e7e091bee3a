"""Calls of ROS's interfaces in C++ and Python, found by words alone.

This is a second, independent reader, against which the graph is counted: regular expressions over text without
comments and strings, which know nothing of types, templates, reachability or what a receiver is. So some of what it
finds is no call of ROS, and what only types tell (members that a constructor's list makes) it does not find.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

CPP: Final = frozenset({".c", ".cc", ".cpp", ".cxx", ".c++", ".h", ".hh", ".hpp", ".hxx", ".ipp"})
PYTHON: Final = frozenset({".py"})
_CPP_WORDS: Final = re.compile(
    r'//[^\n]*|/\*.*?(?:\*/|\Z)|\bu?8?[LUR]*R"([^()\\\s"]{0,16})\(.*?\)\1"'
    r'|"(?:[^"\\\n]|\\.)*"|\'(?:[^\'\\\n]|\\.){1,8}\'',
    re.DOTALL,
)
_PYTHON_WORDS: Final = re.compile(
    r'#[^\n]*|"""(?:[^\\]|\\.)*?(?:"""|\Z)|\'\'\'(?:[^\\]|\\.)*?(?:\'\'\'|\Z)|"(?:[^"\\\n]|\\.)*"|\'(?:[^\'\\\n]|\\.)*\'',
    re.DOTALL,
)
_DEFINE: Final = re.compile(
    r"^[ \t]*#[ \t]*(?:define|if|elif|error|warning|pragma)\b(?:[^\n]*\\\n)*[^\n]*", re.MULTILINE
)
_KEPT: Final = re.compile(r"[^\n]")
_OPENS: Final = r"\s{0,8}[<(]"
_NEW: Final = r"\b(?:new\s{1,4}|make_(?:shared|unique)\s{0,4}<\s{0,4})(?:\w+::){0,3}"
_CPP_CALLS: Final = {
    "publishes": (r"advertise(?:Camera)?", r"create_(?:camera_)?publisher", r""),
    "subscribes": (r"subscribe(?:Camera)?", r"create_(?:camera_)?subscription", r""),
    "provides": (r"advertiseService", r"create_service", r""),
    "calls": (r"serviceClient", r"create_client", r"\bros::service::call"),
    "serves action": (r"", r"", rf"\brclcpp_action::create_server|{_NEW}SimpleActionServer"),
    "calls action": (r"", r"", rf"\brclcpp_action::create_client|{_NEW}SimpleActionClient"),
    "has parameter": (
        r"param|getParam|getParamCached|hasParam|setParam",
        r"declare_parameter|get_parameter|get_parameter_or|has_parameter",
        r"\bros::param::(?:get|getCached|param|has|set)",
    ),
}
"""For each kind the names of members, of functions that may be called without a receiver, and whole expressions."""
_PYTHON_CALLS: Final = {
    "publishes": r"\brospy\.Publisher|\.create_publisher",
    "subscribes": r"\b(?:rospy|message_filters)\.Subscriber|\.create_subscription",
    "provides": r"\brospy\.Service|\.create_service",
    "calls": r"\brospy\.ServiceProxy|\.create_client",
    "serves action": r"(?<!class )\b(?:Simple)?ActionServer",
    "calls action": r"(?<!class )\b(?:Simple)?ActionClient",
    "has parameter": r"\brospy\.(?:get_param|has_param|set_param|get_param_cached)"
    r"|\.(?:declare_parameter|get_parameter|get_parameter_or|has_parameter)",
}
KINDS: Final = tuple(_CPP_CALLS)
"""The relations whose calls are looked for."""
_WHOLE, _IS_MEMBER, _IS_FREE = "whole", "member", "free"
_QUALIFIED: Final = re.compile(r"(?:rclcpp|image_transport)::$")
_BEFORE_FREE: Final = tuple("=([{},;&|?:!")


def _compiled(members: str, free: str, whole: str) -> re.Pattern[str]:
    named = [(_IS_MEMBER, members and rf"\b(?:{members})"), (_IS_FREE, free and rf"\b(?:{free})"), (_WHOLE, whole)]
    return re.compile("|".join(rf"(?P<{name}>(?:{text}){_OPENS})" for name, text in named if text))


_CALLS: Final = {
    "cpp": [(kind, _compiled(*names)) for kind, names in _CPP_CALLS.items()],
    "python": [(kind, _compiled("", "", text)) for kind, text in _PYTHON_CALLS.items()],
}
_MENTIONS: Final = re.compile(
    r"advertise|ubscri|erviceClient|create_|ros::|rospy\.|Action(?:Server|Client)|[pP]aram\b|Param|parameter"
)
"""What a file must have anywhere to have a call."""


@dataclass(frozen=True, slots=True)
class Site:
    """A call: its kind, the line of the name that is called, and the first and the last line of its statement."""

    kind: str
    line: int
    first: int
    last: int


def without_words(text: str, language: str) -> str:
    """Return a text of C++ or Python with blanks for comments, strings and directives; places stay as they are."""
    pattern = _CPP_WORDS if language == "cpp" else _PYTHON_WORDS
    text = pattern.sub(lambda match: _KEPT.sub(" ", match[0]), text)
    return _DEFINE.sub(lambda match: _KEPT.sub(" ", match[0]), text) if language == "cpp" else text


def sites(text: str, language: str) -> Iterator[Site]:
    """Yield the calls in a text of C++ (`cpp`) or Python (`python`), by kind."""
    if not _MENTIONS.search(text):
        return
    code = without_words(text, language)
    starts = [0, *(match.end() for match in re.finditer("\n", code))]
    for kind, pattern in _CALLS[language]:
        for match in pattern.finditer(code):
            if _is_call(code, match.start(), match.lastgroup):
                at = match.end() - 1
                line = bisect_right(starts, at)
                first = bisect_right(starts, _statement_start(code, match.start(), language))
                last = bisect_right(starts, statement_end(code, at))
                yield Site(kind, line, min(first, line), max(last, line))


def _is_call(code: str, at: int, how: str | None) -> bool:
    """Tell by what stands before a name of C++ whether it is called there, or declared."""
    if how == _WHOLE:
        return True
    before = code[max(0, at - _FURTHEST // 10) : at].rstrip()
    before = before.removesuffix("template").rstrip()
    if before.endswith((".", "->")):
        return True
    before = _QUALIFIED.sub("", before).rstrip()
    free = before.endswith(_BEFORE_FREE) and not before.endswith("::")
    return how == _IS_FREE and (free or not before or re.search(r"\breturn$", before) is not None)


_FURTHEST: Final = 4_000
"""Characters of the longest statement that is looked at."""


def _statement_start(code: str, at: int, language: str) -> int:
    """Return where the statement around a place begins, as far as marks tell."""
    begin = max(0, at - _FURTHEST)
    before = code[begin:at]
    if language == "cpp":
        cut = max(before.rfind(";"), before.rfind("{"), before.rfind("}")) + 1
    else:
        cut = before.rfind("\n") + 1
        while cut and before[: cut - 1].rstrip(" \t").endswith(("(", ",", "\\", "[")):
            cut = before.rfind("\n", 0, cut - 1) + 1
    blanks = len(code[begin + cut : at]) - len(code[begin + cut : at].lstrip())
    return begin + cut + blanks


def statement_end(code: str, at: int) -> int:
    """Return where the brackets that are open from a place on are closed, or where the statement ends."""
    depth = 0
    for place in range(at, min(len(code), at + _FURTHEST)):
        sign = code[place]
        if sign in "([{":
            depth += 1
        elif sign in ")]}":
            depth -= 1
            if depth <= 0:
                return place
        elif sign == ";" and depth <= 0:
            return place
    return at


def line_end(code: str) -> int:
    """Return where the first line ends, or the one on which all brackets are closed that the first one opens."""
    depth = 0
    for place, sign in enumerate(code):
        if sign in "([{":
            depth += 1
        elif sign in ")]}":
            depth -= 1
        elif sign == "\n" and depth <= 0:
            return place
    return len(code)
