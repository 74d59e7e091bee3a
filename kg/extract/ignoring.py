"""Which subscriptions ignore their messages: the callback is empty, or only logs.

The callback is a function of the file that subscribes, or a lambda in the call. It counts only if no other function of
the package has its name, which could override it.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kg.extract.codetext import CodeText

_NESTED: Final = r"\((?:[^()]|\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\))*\)"
"""Parentheses with their content, four deep."""
_CPP_IDLE: Final = re.compile(
    r"\b(?:ROS|RCLCPP|NODELET)_(?:DEBUG|INFO|WARN|ERROR|FATAL)\w*\s*\([^;{}]*;|\b(?:std::)?c(?:out|err)\b[^;{}]*;"
    r"|\b(?:std::)?f?printf\s*\([^;{}]*;|\(void\)\s*\w+\s*;|\breturn\s*;|[;\s]"
)
_PYTHON_IDLE: Final = re.compile(
    r"\b(?:pass|return(?:[ \t]+None)?)[ \t]*$|\brospy\.log\w+\s*" + _NESTED + r"|\b(?:\w+\.)*(?:get_)?logger(?:\(\))?"
    r"\.(?:debug|info|warn|warning|error|fatal)\s*" + _NESTED + r"|\bprint\b[ \t]*(?:" + _NESTED + r"|[^\n(]*$)|[;\s]",
    re.MULTILINE,
)
_LAMBDA: Final = re.compile(r"\]\s*(?:\([^()]*\)\s*)?(?:mutable\s*)?(?:->\s*[\w:]+\s*)?\{([^{}]*)\}")
_WORD: Final = re.compile(r"[A-Za-z_]\w*+(?!\s*::)")
"""A word that is not a scope."""


def ignores_messages(file: CodeText, line: int, with_word: Callable[[str], Iterable[CodeText]]) -> bool:
    """Check whether the callback of the subscription on a line of a file does nothing with its messages.

    `with_word` returns the files of the package with a word.
    """
    start, end = file.call(line)
    call = file.code[start : end + 1]
    bodies = _LAMBDA.findall(call) if not file.python else []
    if bodies:
        return len(bodies) == 1 and _is_idle(bodies[0], file)
    words = set(_WORD.findall(call))
    named = [one for one in file.functions if one.name in words]
    if len(named) != 1:
        return False
    callback = named[0]
    if not _is_idle(file.code[callback.body : callback.end], file):
        return False
    same = [one for other in with_word(callback.name) for one in other.functions if one.name == callback.name]
    return len(same) == 1


def _is_idle(body: str, file: CodeText) -> bool:
    return not (_PYTHON_IDLE if file.python else _CPP_IDLE).sub("", body)
