"""HTML for the texts of rules and queries: paragraphs, lists and code, and source with highlighted tokens.

All input is escaped; only elements created here are markup.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import groupby
from typing import Final

from markupsafe import Markup, escape

_ITEM: Final = re.compile(r"(?:[-*]|\d+[.)]) +")
_CODE: Final = re.compile(r"`([^`\n]+)`")
_TOKEN: Final = re.compile(
    r"""(?P<iri><[^<>"{}|^`\\\s]*>)"""
    r"""|(?P<string>\"{3}.*?\"{3}|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*')"""
    r"""|(?P<comment>\#[^\n]*)"""
    r"""|(?P<variable>[?$]\w+)"""
    r"""|(?P<name>[A-Za-z][\w.-]*:[\w.-]*|_:\w+|:[\w-]+)"""
    r"""|(?P<number>\b\d+(?:\.\d+)?\b)"""
    r"""|(?P<keyword>@?\b(?:PREFIX|BASE|SELECT|CONSTRUCT|ASK|DESCRIBE|WHERE|FILTER|NOT|EXISTS|OPTIONAL|UNION|MINUS|BIND|AS"""
    r"""|VALUES|GRAPH|GROUP|BY|HAVING|ORDER|LIMIT|OFFSET|DISTINCT|REDUCED|UNDEF|IN|RULE|DATA|IF|THEN|SET|a)\b)""",
    re.IGNORECASE | re.DOTALL | re.VERBOSE,
)
_BREAKS: Final = re.compile(r"(?<=[/_:<(,])(?=[^/_:<(,])|(?<=[a-z])(?=[A-Z])")


def breakable(text: str) -> Markup:
    """Return a name, path or line of code with break opportunities: after `/_:<(,`, and between joined words."""
    return Markup("<wbr>").join(_BREAKS.split(text))


def prose(text: str) -> Markup:
    """Return a text as paragraphs, lists (lines that begin with `-` or a number) and code (indented lines)."""
    return Markup("\n").join(_block(kind, list(lines)) for kind, lines in groupby(text.splitlines(), _kind) if kind)


def _kind(line: str) -> str:
    if not line.strip():
        return ""
    if _ITEM.match(line):
        return "ul"
    return "pre" if line.startswith("    ") else "ul" if line.startswith(" ") else "p"


def _block(kind: str, lines: list[str]) -> Markup:
    if kind == "pre":
        return Markup('<pre tabindex="0">{}</pre>').format("\n".join(line[4:] for line in lines))
    if kind == "p":
        return Markup("<p>{}</p>").format(inline(" ".join(lines)))
    items: list[str] = []
    for line in lines:
        if _ITEM.match(line) or not items:
            items.append(_ITEM.sub("", line, count=1))
        else:
            items[-1] += f" {line.strip()}"
    return Markup("<ul>{}</ul>").format(Markup("").join(Markup("<li>{}</li>").format(inline(item)) for item in items))


def inline(text: str) -> Markup:
    """Return a text without blocks, with parts in backticks as code."""
    parts = (
        Markup("<code>{}</code>").format(part) if place % 2 else escape(part)
        for place, part in enumerate(_CODE.split(text))
    )
    return Markup("").join(parts)


def source(text: str) -> Markup:
    """Return SPARQL, Turtle or SRL as lines with the ids `L1`, `L2`, ..., each token marked with its kind."""
    lines = Markup("").join(_tokens(text)).split("\n")
    return Markup("").join(Markup('<span id="L{}">{}\n</span>').format(*pair) for pair in enumerate(lines, 1))


def _tokens(text: str) -> Iterator[Markup]:
    """Yield the tokens of a text; a token of several lines is repeated for each of them."""
    end = 0
    for match in _TOKEN.finditer(text):
        yield escape(text[end : match.start()])
        lines = (
            Markup('<span class="tok-{}">{}</span>').format(match.lastgroup, line) for line in match[0].split("\n")
        )
        yield Markup("\n").join(lines)
        end = match.end()
    yield escape(text[end:].rstrip("\n"))
