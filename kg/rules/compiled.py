"""Cache of parsed rules for the next process: reading them costs more than a small change or a proof.

    .kg/cache/compiled        cut to the axioms of the store, in their order: what evaluation needs
    .kg/cache/uncut           as their files have them: what proofs need

A file holds a digest of the sources of the rules, one of the rest, and the rules pickled. Only the classes of the
internal form and of terms are made from it, so a file that somebody else put there can do no harm.
"""

from __future__ import annotations

import io
import pickle
from dataclasses import dataclass, fields, is_dataclass
from hashlib import blake2b
from pathlib import Path
from typing import Any, Final

from kg.rules.dependencies import patterns
from kg.rules.files import Documentation, RuleFile, RuleSet
from kg.rules.form import Atom, Expression, Rule
from kg.rules.stratify import Stratum, stratify
from kg.store.layout import write_atomically
from kg.store.terms import Term

_NAME: Final = "compiled"
_UNCUT: Final = "uncut"
_BYTES: Final = 16
_CLASSES: Final = frozenset(
    {
        *(("kg.rules.form", name) for name in ("Aggregate", "Assignment", "Atom", "Column", "EngineBlock", "Exists")),
        ("kg.rules.stratify", "Stratum"),
        *(("kg.rules.form", name) for name in ("Expression", "Filter", "Rule", "Values")),
        *(("kg.syntax.terms", name) for name in ("TripleTerm", "Variable")),
        *(("pyoxigraph", name) for name in ("BlankNode", "Literal", "NamedNode", "Triple")),
        ("kg.errors", "Place"),
        ("builtins", "frozenset"),
    }
)


@dataclass(frozen=True, slots=True)
class Packed:
    """Rules as `load` returns them, and pickled."""

    rules: RuleSet
    content: bytes


class _Writer(pickle.Pickler):
    """Writes data classes as calls with their fields, which are read in half the time.

    Of rules that are `cut`, equal parts are written once, and only rules and blocks keep their places.
    """

    def __init__(self, file: io.BytesIO, *, cut: bool) -> None:
        super().__init__(file, pickle.HIGHEST_PROTOCOL)
        self._cut = cut
        self._parts: dict[Any, Any] = {}

    def reducer_override(self, value: Any) -> Any:
        if not is_dataclass(value) or isinstance(value, type):
            return NotImplemented
        given = tuple(getattr(value, one.name) for one in fields(value) if one.init)
        if self._cut and isinstance(value, Atom | Expression):
            given = (*given[:-1], None)
        return type(value), self._shared(given) if self._cut else given

    def _shared(self, part: Any) -> Any:
        """Return a part, or an equal one that was written before."""
        if isinstance(part, tuple):
            return tuple(map(self._shared, part))
        return self._parts.setdefault(part, part) if is_dataclass(part) or isinstance(part, Term) else part


class _Reader(pickle.Unpickler):
    """Makes nothing but rules and terms."""

    def find_class(self, module: str, name: str) -> Any:
        if (module, name) not in _CLASSES:
            raise pickle.UnpicklingError(f"{module}.{name}")
        return super().find_class(module, name)


def load(cache: Path, mark: str, *, cut: bool = True) -> RuleSet | None:
    """Return the cached rules below `cache` whose digest is `mark`; None without such.

    They are in one file without text or documentation.
    """
    found = packed(cache, mark, cut=cut)
    return found.rules if found else None


def packed(cache: Path, mark: str, *, cut: bool = True) -> Packed | None:
    """Return what `load` returns, with its content."""
    try:
        content = (cache / (_NAME if cut else _UNCUT)).read_bytes()
    except OSError:
        return None
    head, rest = content[: 2 * _BYTES], content[2 * _BYTES :]
    if head != _digest(mark.encode()) + _digest(rest):
        return None
    try:
        return Packed(_together(*_Reader(io.BytesIO(rest)).load()), rest)
    except (pickle.UnpicklingError, AttributeError, TypeError, ValueError):
        return None


def save(cache: Path, mark: str, rule_set: RuleSet, *, cut: bool = True) -> RuleSet:
    """Keep rules, and return them as `load` will; those that are not `cut` have no order yet.

    Raises OSError when they cannot be written, and RuleError KG202, KG204 where they have no order.
    """
    return write(cache, mark, pack(rule_set, cut=cut), cut=cut)


def pack(rule_set: RuleSet, *, cut: bool = True) -> Packed:
    """Put rules in order and pickle them, which does not depend on where they are kept; errors as `save`."""
    strata = tuple(stratify(rule_set.rules, bounded=True)) if cut else ()
    prefixes = {name: iri for file in rule_set.files for name, iri in file.prefixes.items()}
    named = patterns(rule_set.rules, rule_set.data)
    parts = (rule_set.rules, rule_set.data, prefixes, strata, rule_set.digest, named)
    written = io.BytesIO()
    _Writer(written, cut=cut).dump(parts)
    return Packed(_together(*parts), written.getvalue())


def write(cache: Path, mark: str, packed: Packed, *, cut: bool = True) -> RuleSet:
    """Keep packed rules below the folder `cache`, and return them. Raises OSError when they cannot be written."""
    content = _digest(mark.encode()) + _digest(packed.content) + packed.content
    cache.mkdir(parents=True, exist_ok=True)
    write_atomically(cache / (_NAME if cut else _UNCUT), content, durable=False)
    return packed.rules


def _together(  # noqa: PLR0913, PLR0917 - the parts of a file
    rules: tuple[Rule, ...],
    data: Any,
    prefixes: dict[str, str],
    strata: tuple[Stratum, ...],
    digest: str,
    named: frozenset[str],
) -> RuleSet:
    file = RuleFile(_NAME, Path(_NAME), "", Documentation(), rules, data, prefixes)
    return RuleSet((file,), strata, digest, named)


def _digest(content: bytes) -> bytes:
    return blake2b(content, digest_size=_BYTES).digest()
