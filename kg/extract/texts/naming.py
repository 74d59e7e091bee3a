"""Which words of a text mean a node: its names, in the ways that people write them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Final

from kg.extract.buildmodel import last_part
from kg.holes import is_partial
from kg.names import key

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kg.facts import NodeType

_TOKEN: Final = re.compile(r"[A-Za-z0-9](?:[A-Za-z0-9_.\-]|::|/)*[A-Za-z0-9]|[A-Za-z0-9]")
_KINDS: Final = frozenset(
    {"node", "nodes", "nodelet", "nodelets", "component", "components", "executable", "plugin", "program"}
)
_KIND_WORDS: Final = r"(?:ros2? )?(?:node|nodelet|component|executable|plugin|program|script)\b"
_SUFFIX: Final = re.compile(r"(?:nodelet|node|component)$")
_ENDINGS: Final = (".py", ".cpp", ".cc", ".hpp", ".h", ".launch", ".exe")
_SHORTEST_DISTINCT: Final = 5
_SHORTEST_STEM: Final = 4
_REMEMBERED: Final = 8192
"""Words whose forms are kept, for pages are read for each package around which they stand."""


@dataclass(frozen=True, slots=True)
class _Name:
    """A name of a node; `distinct` ones mean the node wherever they are, others only if the context shows it."""

    node: str
    distinct: bool


class Names:
    """The names of the nodes of a package.

    Names that are common (those of packages) mean a node only beside the word `node`; `is_common` is given their `key`.
    """

    def __init__(self, nodes: Iterable[NodeType], is_common: Callable[[str], bool]) -> None:
        self._is_common = is_common
        self._names: dict[str, list[_Name]] = {}
        for node in nodes:
            for name in _names_of(node):
                entries = self._names.setdefault(key(name), [])
                if all(one.node != node.name for one in entries):
                    entries.append(_Name(node.name, _is_distinct(name)))
        for node in nodes:
            for name in _names_of(node):
                stem = _SUFFIX.sub("", key(name))
                if len(stem) >= _SHORTEST_STEM and stem != key(name) and stem not in self._names:
                    self._names[stem] = [_Name(node.name, distinct=False)]

    def __bool__(self) -> bool:
        return bool(self._names)

    def mentioned(self, text: bytes) -> bool:
        """Return whether a page may name a node: a filter with false positives."""
        flat = text.lower().replace(b"_", b"").replace(b"-", b"").replace(b" ", b"")
        return any(name.encode() in flat for name in self._names)

    def of_heading(self, heading: str) -> tuple[str, ...]:
        """Return the nodes that a heading is about: it is the name of one, or names one with few other words."""
        text = re.sub(r"^[\d.]+\s+", "", heading).strip(" :`")
        whole = key(text.replace(" ", ""))
        for candidate in (whole, _SUFFIX.sub("", whole.removesuffix("s"))):
            if candidate in self._names and not self._is_common(candidate):
                return tuple(name.node for name in self._names[candidate])
        tokens = _tokens(text)
        if len([token for token in tokens if key(token) not in _KINDS]) > _LONGEST_HEADING:
            return ()
        kind = any(token.lower() in _KINDS for token in tokens)
        return self._first(tokens, lambda name, common: (name.distinct or kind) and (kind or not common))

    def of_lead(self, lead: str) -> tuple[str, ...]:
        """Return the nodes that the first words of an item or row name: nothing else is in `lead`."""
        tokens = [token for token in _tokens(lead) if token.lower() not in _KINDS]
        if len(tokens) != 1:
            return ()
        return self._first(tokens, lambda _, common: not common)

    def of_text(self, text: str, spans: Iterable[str] = ()) -> tuple[str, ...]:
        """Return the nodes that a paragraph names; `spans` are its words in `code` or bold."""
        marked = {key(last) for span in spans for last in (span, last_part(span))}
        nodes: dict[str, None] = {}
        for token in dict.fromkeys(_tokens(text)):
            for candidate in _forms(token):
                for name in self._names.get(candidate, ()):
                    common = self._is_common(candidate)
                    if (
                        not common and (candidate in marked or (name.distinct and _is_distinct(token)))
                    ) or _is_called_node(token, text):
                        nodes[name.node] = None
        return tuple(nodes)

    def _first(self, tokens: Iterable[str], fits: Callable[[_Name, bool], bool]) -> tuple[str, ...]:
        for token in tokens:
            for candidate in _forms(token):
                names = [n.node for n in self._names.get(candidate, ()) if fits(n, self._is_common(candidate))]
                if names:
                    return tuple(names)
        return ()


_LONGEST_HEADING: Final = 4
"""Words of a heading that is still about the one that it names."""


def _names_of(node: NodeType) -> list[str]:
    plugin = [node.plugin, last_part(node.plugin)] if node.plugin else []
    given = [node.name, node.executable, node.node_name, *node.aliases, *plugin]
    names = [name for name in given if name and not is_partial(name)]
    return list(dict.fromkeys(name for one in names for name in (one, _without_ending(one))))


def _without_ending(token: str) -> str:
    return next((token.removesuffix(ending) for ending in _ENDINGS if token.endswith(ending)), token)


def _is_distinct(name: str) -> bool:
    """Return whether a name is not a word of a language: it has an underscore, a digit or a capital within."""
    inner = "_" in name or "::" in name or any(map(str.isdigit, name)) or any(map(str.isupper, name[1:]))
    return inner and len(name) >= _SHORTEST_DISTINCT and not name.isupper()


def _tokens(text: str) -> list[str]:
    return _TOKEN.findall(text)


@lru_cache(_REMEMBERED)
def _forms(token: str) -> tuple[str, ...]:
    bare = _without_ending(token)
    return tuple(dict.fromkeys((key(bare), key(last_part(bare)))))


def _is_called_node(token: str, text: str) -> bool:
    """Return whether a paragraph calls a word a node."""
    name = re.escape(token)
    called = rf"(?<![\w/]){name}['\"*]* {_KIND_WORDS}|{_KIND_WORDS}[ '\"*(:]+{name}(?![\w/])"
    return re.search(called, text, re.IGNORECASE) is not None
