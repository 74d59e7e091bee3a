"""IMPORTS of SPARQL 1.2 RL (section 3.5 of its text): the rule sets that a rule set brings with it, each once."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote, urlsplit

from kg.errors import RuleError
from kg.syntax.lexer import normalise
from kg.syntax.parser import parse_srl
from kg.syntax.position import place_at

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pyoxigraph import NamedNode

    from kg.syntax.tree import RuleUnit

__all__ = ["imported"]


def imported(unit: RuleUnit, path: Path, text: str) -> Iterator[tuple[Path, str, RuleUnit]]:
    """Yield path, text and tree of each rule set that a rule set imports, also through others; cycles end.

    Raises RuleError: KG208 for an import that is not a file here, KG201 for one that does not parse.
    """
    seen = {path.resolve()}
    waiting = [(unit, path, text)]
    while waiting:
        importing, source, written = waiting.pop(0)
        for target in importing.imports:
            file = _file(target, source, written).resolve()
            if file in seen:
                continue
            seen.add(file)
            inner = _read(file, target, source, written)
            found = (file, inner, parse_srl(inner, str(file)))
            yield found
            waiting.append((found[2], file, inner))


def _file(target: NamedNode, source: Path, text: str) -> Path:
    parts = urlsplit(target.value)
    if parts.scheme != "file" or parts.netloc not in {"", "localhost"}:
        hint = "Rule sets are not fetched: save it next to this file and import it by its name."
        raise _error(f"`{target.value}` is not a file of this machine", target, source, text, hint)
    return Path(unquote(parts.path))


def _read(file: Path, target: NamedNode, source: Path, text: str) -> str:
    try:
        return file.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8"
        hint = "A relative name is relative to the importing file, or to its BASE."
        raise _error(f"`{file.name}` cannot be imported: {reason}", target, source, text, hint) from None


def _error(message: str, target: NamedNode, source: Path, text: str, hint: str) -> RuleError:
    """Return an error at the importing statement, if the text allows to find it."""
    written = normalise(text)
    name = target.value.rpartition("/")[2]
    keyword = max(written.upper().find("IMPORTS"), 0)
    offset = max(written.find(name, keyword), keyword)
    return RuleError("KG208", message, place=place_at(written, offset, str(source)), hint=hint)
