"""The built-in functions of SPARQL with their numbers of arguments."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

Arguments = tuple[int, int | None]
"""Minimum and maximum number of arguments; None for unlimited."""

AGGREGATES: Final = frozenset({"COUNT", "SUM", "MIN", "MAX", "AVG", "SAMPLE", "GROUP_CONCAT"})

_BY_ARGUMENTS: Final[Mapping[Arguments, str]] = {
    (0, 0): "NOW UUID STRUUID",
    (0, 1): "BNODE",
    (0, None): "CONCAT",
    (1, 1): "STR LANG LANGDIR DATATYPE IRI URI ABS CEIL FLOOR ROUND STRLEN UCASE LCASE ENCODE_FOR_URI YEAR MONTH DAY"
    " HOURS MINUTES SECONDS TIMEZONE TZ ISIRI ISURI ISBLANK ISLITERAL ISNUMERIC HASLANG HASLANGDIR ISTRIPLE SUBJECT"
    " PREDICATE OBJECT",
    (2, 2): "LANGMATCHES CONTAINS STRSTARTS STRENDS STRBEFORE STRAFTER STRLANG STRDT SAMETERM",
    (2, 3): "SUBSTR REGEX",
    (3, 3): "IF STRLANGDIR TRIPLE",
    (3, 4): "REPLACE",
}

RULE_FUNCTIONS: Final[Mapping[str, Arguments]] = MappingProxyType(
    {name: arguments for arguments, names in _BY_ARGUMENTS.items() for name in names.split()}
)
"""Functions of SPARQL 1.2 RL (production BuiltInCall), in upper case."""

FUNCTIONS: Final[Mapping[str, Arguments]] = MappingProxyType(
    {
        **RULE_FUNCTIONS,
        "BOUND": (1, 1),
        "COALESCE": (0, None),
        "RAND": (0, 0),
        **dict.fromkeys(("MD5", "SHA1", "SHA256", "SHA384", "SHA512"), (1, 1)),
    }
)
"""Functions of SPARQL 1.1 and 1.2 (production BuiltInCall), in upper case."""
