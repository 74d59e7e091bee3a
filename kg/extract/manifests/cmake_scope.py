"""Variables of CMake and the evaluation of variable references in arguments.

Every variable has a text, its list elements separated by `;`. A variable is uncertain when its value depends
on what is not known before configuring: an option, a result of find_package, both branches of an `if`.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Final

_LONGEST: Final = 200
_MOST_STEPS: Final = 2_000_000
_NESTED: Final = re.compile(r"\)[+*?]|[+*?][+*?]")


@lru_cache(256)
def _compile(written: str) -> tuple[re.Pattern[str], int] | None:
    """Return the expression and how many repetitions it has; None for those that are too long, nested or malformed.

    In CMake's language braces are ordinary characters.
    """
    if len(written) > _LONGEST or _NESTED.search(written):
        return None
    try:
        return re.compile(re.sub(r"(?<!\\)([{}])", r"\\\1", written)), sum(written.count(mark) for mark in "+*?")
    except re.error:
        return None


def _usable(written: str, text: str) -> re.Pattern[str] | None:
    """Return the expression if matching `text` is bound to end soon: backtracking costs a power of the length."""
    compiled = _compile(written)
    if compiled is None or len(text) ** (compiled[1] + 1) > _MOST_STEPS:
        return None
    return compiled[0]


def matches(written: str, text: str) -> bool | None:
    """Return whether the expression matches somewhere in `text`; None where it is not run."""
    pattern = _usable(written, text)
    return None if pattern is None else pattern.search(text) is not None


def replace_all(written: str, replacement: str, text: str) -> str:
    r"""Return `text` with each match replaced, `\1` standing for groups; unchanged where the expression is not run."""
    pattern = _usable(written, text)
    if pattern is None:
        return text

    def fill(match: re.Match[str]) -> str:
        groups = (match[0], *match.groups(""))
        return re.sub(
            r"\\(\d)", lambda found: groups[int(found[1])] if int(found[1]) < len(groups) else "", replacement
        )

    return pattern.sub(fill, text)


def keep_matching(written: str, items: list[str], *, wanted: bool) -> list[str]:
    """Return the items that the expression matches, or those that it does not; all where it is not run."""
    return [item for item in items if matches(written, item) in {wanted, None}]


LONGEST_VALUE: Final = 200_000
"""Characters after which a value is cut, so that no list that doubles itself exhausts memory."""

_REFERENCE: Final = re.compile(r"(?<!\\)\$(ENV|CACHE)?\{([A-Za-z0-9_./+\-@:]*)\}")
_ESCAPE: Final = re.compile(r"\\(.)", re.DOTALL)
_ESCAPES: Final = {"n": "\n", "t": "\t", "r": "\r", "0": "\0"}
_DEEPEST_NESTING: Final = 20
_GENERATOR: Final = re.compile(r"\$<([^<>:]*)(?::([^<>]*))?>")


class Scope:
    """Variables of one scope; functions and subdirectories get a child that starts as a copy."""

    def __init__(self, variables: dict[str, str], uncertain: set[str], parent: Scope | None = None) -> None:
        self.variables = variables
        self.uncertain = uncertain
        self.parent = parent

    def child(self) -> Scope:
        """Return a scope that sees all variables and whose settings stay its own."""
        return Scope(dict(self.variables), set(self.uncertain), self)

    def set(self, name: str, value: str, *, certain: bool = True) -> None:
        """Set a variable to a text; longer ones than `LONGEST_VALUE` are cut at an element."""
        if len(value) > LONGEST_VALUE:
            value = value[:LONGEST_VALUE].rpartition(";")[0]
        self.variables[name] = value
        if certain:
            self.uncertain.discard(name)
        else:
            self.uncertain.add(name)

    def unset(self, name: str) -> None:
        """Forget a variable."""
        self.variables.pop(name, None)
        self.uncertain.discard(name)

    def expand(self, text: str) -> tuple[str, bool]:
        """Return `text` with references and escapes evaluated, and whether all of it is certain."""
        certain = True
        if "$" in text:
            text, certain = self._references(text)
        if "\\" in text:
            text = _ESCAPE.sub(lambda match: _ESCAPES.get(match[1], match[1]), text.replace("\\;", "\\\\;"))
        return text, certain

    def _references(self, text: str) -> tuple[str, bool]:
        certain = True

        def value(match: re.Match[str]) -> str:
            nonlocal certain
            name = f"ENV{{{match[2]}}}" if match[1] == "ENV" else match[2]
            if name not in self.variables or name in self.uncertain:
                certain = False
            return self.variables.get(name, "")

        for _ in range(_DEEPEST_NESTING):
            text, count = _REFERENCE.subn(value, text)
            if not count or len(text) > LONGEST_VALUE:
                break
        return text[:LONGEST_VALUE], certain

    def merge(self, others: list[Scope]) -> None:
        """Merge the scopes of branches into this one; any may have been the one taken."""
        before, doubtful = self.variables.items(), self.uncertain
        names = {name for other in others for name, _ in other.variables.items() ^ before}
        names.update(name for other in others for name in other.uncertain ^ doubtful)
        for name in names:
            values = {other.variables.get(name): None for other in others}
            if len(values) == 1:
                value = next(iter(values))
                certain = not any(name in other.uncertain for other in others)
                self.unset(name) if value is None else self.set(name, value, certain=certain)
            else:
                elements = dict.fromkeys(part for value in values if value for part in split_list(value))
                self.set(name, ";".join(elements), certain=False)


def split_list(value: str) -> list[str]:
    r"""Return the elements of a list, empty ones left out; `\;` does not separate."""
    if "\\;" not in value:
        return [part for part in value.split(";") if part]
    return [part.replace("\0", ";") for part in value.replace("\\;", "\0").split(";") if part]


def strip_generators(text: str) -> str:
    """Return the text with generator expressions replaced by a possible value: the part after the last colon."""
    for _ in range(_DEEPEST_NESTING):
        if "$<" not in text:
            break
        replaced = _GENERATOR.sub(lambda match: match[2] or "", text)
        if replaced == text:
            break
        text = replaced
    return text
