"""Rules as they were read and cut last, kept for the next process: a small change costs less than reading them.

    .kg/cache/compiled

The file holds what the rules were made of, as a digest, one of the rest, and the rules pickled. Only the classes of the
internal form and of terms are made from it, so a file that somebody else put there can do no harm.
"""

from __future__ import annotations

import io
import pickle
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from kg.rules.files import Documentation, RuleFile, RuleSet
from kg.store.layout import write_atomically

if TYPE_CHECKING:
    from kg.rules.form import Rule

__all__ = ["load", "save"]

_NAME: Final = "compiled"
_BYTES: Final = 16
_CLASSES: Final = frozenset(
    {
        *(("kg.rules.form", name) for name in ("Aggregate", "Assignment", "Atom", "Column", "EngineBlock", "Exists")),
        *(("kg.rules.form", name) for name in ("Expression", "Filter", "Rule", "TripleTerm", "Values", "Variable")),
        *(("pyoxigraph", name) for name in ("BlankNode", "Literal", "NamedNode", "Triple")),
        ("kg.errors", "Place"),
        ("builtins", "frozenset"),
    }
)


class _Reader(pickle.Unpickler):
    """Makes nothing but rules and terms."""

    def find_class(self, module: str, name: str) -> Any:
        if (module, name) not in _CLASSES:
            raise pickle.UnpicklingError(f"{module}.{name}")
        return super().find_class(module, name)


def load(cache: Path, mark: str) -> RuleSet | None:
    """Return the rules below the folder `cache` that were made of what `mark` stands for; None without such.

    They stand in one file without text, as it is evaluation that needs them.
    """
    try:
        content = (cache / _NAME).read_bytes()
    except OSError:
        return None
    head, packed = content[: 2 * _BYTES], content[2 * _BYTES :]
    if head != _digest(mark.encode()) + _digest(packed):
        return None
    try:
        rules, data = _Reader(io.BytesIO(packed)).load()
    except (pickle.UnpicklingError, AttributeError, TypeError, ValueError):
        return None
    return _together(rules, data)


def save(cache: Path, mark: str, rule_set: RuleSet) -> RuleSet:
    """Keep rules, and return them as `load` will; OSError when they cannot be written."""
    packed = pickle.dumps((rule_set.rules, rule_set.data), protocol=pickle.HIGHEST_PROTOCOL)
    content = _digest(mark.encode()) + _digest(packed) + packed
    cache.mkdir(parents=True, exist_ok=True)
    write_atomically(cache / _NAME, content, durable=False)
    return _together(rule_set.rules, rule_set.data)


def _together(rules: tuple[Rule, ...], data: Any) -> RuleSet:
    return RuleSet((RuleFile(_NAME, Path(_NAME), "", Documentation(), rules, data),))


def _digest(content: bytes) -> bytes:
    return blake2b(content, digest_size=_BYTES).digest()
