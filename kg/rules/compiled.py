"""Rules as they were read and cut last, kept for the next process: a small change costs less than reading them.

    .kg/cache/compiled

The file holds what the rules were made of, as a digest, one of the rest, and the rules pickled. Only the classes of the
internal form and of terms are made from it, so a file that somebody else put there can do no harm.
"""

from __future__ import annotations

import io
import pickle
from dataclasses import fields, is_dataclass
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from kg.rules.files import Documentation, RuleFile, RuleSet
from kg.rules.stratify import stratify
from kg.store.layout import write_atomically

if TYPE_CHECKING:
    from kg.rules.form import Rule
    from kg.rules.stratify import Stratum

__all__ = ["load", "save"]

_NAME: Final = "compiled"
_BYTES: Final = 16
_CLASSES: Final = frozenset(
    {
        *(("kg.rules.form", name) for name in ("Aggregate", "Assignment", "Atom", "Column", "EngineBlock", "Exists")),
        ("kg.rules.stratify", "Stratum"),
        *(("kg.rules.form", name) for name in ("Expression", "Filter", "Rule", "TripleTerm", "Values", "Variable")),
        *(("pyoxigraph", name) for name in ("BlankNode", "Literal", "NamedNode", "Triple")),
        ("kg.errors", "Place"),
        ("builtins", "frozenset"),
    }
)


class _Writer(pickle.Pickler):
    """Writes data classes as calls with their fields, which are read in half the time."""

    def reducer_override(self, value: Any) -> Any:
        if is_dataclass(value) and not isinstance(value, type):
            return type(value), tuple(getattr(value, one.name) for one in fields(value) if one.init)
        return NotImplemented


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
        return _together(*_Reader(io.BytesIO(packed)).load())
    except (pickle.UnpicklingError, AttributeError, TypeError, ValueError):
        return None


def save(cache: Path, mark: str, rule_set: RuleSet) -> RuleSet:
    """Keep rules, and return them as `load` will.

    Raises OSError when they cannot be written, and RuleError KG202, KG204 where they have no order.
    """
    parts = (rule_set.rules, rule_set.data, tuple(stratify(rule_set.rules, bounded=True)), rule_set.digest)
    written = io.BytesIO()
    _Writer(written, pickle.HIGHEST_PROTOCOL).dump(parts)
    packed = written.getvalue()
    content = _digest(mark.encode()) + _digest(packed) + packed
    cache.mkdir(parents=True, exist_ok=True)
    write_atomically(cache / _NAME, content, durable=False)
    return _together(*parts)


def _together(rules: tuple[Rule, ...], data: Any, strata: tuple[Stratum, ...], digest: str) -> RuleSet:
    return RuleSet((RuleFile(_NAME, Path(_NAME), "", Documentation(), rules, data),), strata, digest)


def _digest(content: bytes) -> bytes:
    return blake2b(content, digest_size=_BYTES).digest()
