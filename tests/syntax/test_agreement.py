"""The parser of rules and the engine's own agree on the queries of the W3C's tests of SPARQL 1.1."""

from __future__ import annotations

import re

import pytest
from pyoxigraph import Store
from repository import ROOT
from syntax.printing import plain

from kg.errors import RuleError
from kg.syntax.names import PREFIXES
from kg.syntax.parser import parse_rq

FOLDER = ROOT.parent / "shared" / "w3c" / "rdf-tests" / "sparql"
PROLOGUE = re.compile(r"(?:\s|#[^\n]*|BASE\s*<[^>]*>|PREFIX\s+[^\s:]*:\s*<[^>]*>)*", re.IGNORECASE)
ENGINE = Store()


def as_rule(query: str) -> str | None:
    """Return a query of any kind as a CONSTRUCT with the same pattern, or None if impossible."""
    found = PROLOGUE.match(query)
    prologue, rest = (found.group(), query[found.end() :]) if found else ("", query)
    kind = (re.match(r"\w*", rest) or [""])[0].upper()
    base = "BASE <http://example.org/base/>\n"
    if kind == "SELECT":
        return f"{base}{prologue} CONSTRUCT {{ }} WHERE {{ {rest}\n}}"
    if kind == "ASK":
        return f"{base}{prologue} CONSTRUCT {{ }} WHERE {rest[3:]}"
    return f"{base}{prologue}{rest}" if kind == "CONSTRUCT" else None


def engine_accepts(query: str) -> bool:
    """Whether the engine can parse a query."""
    try:
        ENGINE.query(query, prefixes=dict(PREFIXES))
    except SyntaxError:
        return False
    except (OSError, ValueError, RuntimeError):
        return True
    return True


def test_rules_and_engine_accept_the_same_queries() -> None:
    """Queries that the engine parses are accepted or KG209 (not for rules), and all others are KG201."""
    if not FOLDER.is_dir():
        pytest.skip(f"{FOLDER} is not there: the W3C's tests are not part of this repository")
    queries = [(path, as_rule(path.read_text())) for path in sorted(FOLDER.rglob("*.rq"))]
    wrong = [path.name for path, query in queries if query and "service" not in query.lower() and differs(query)]
    assert not wrong
    assert len(queries) > 300


def differs(query: str) -> bool:
    """Whether rules and engine differ on a query, or its pattern changes when printed."""
    try:
        (rule,) = parse_rq(query, "x.rq").rules
    except RuleError as error:
        return engine_accepts(query) != (error.code == "KG209")
    (again,) = parse_rq(f"CONSTRUCT {{ }} WHERE {rule.group.text}", "x.rq").rules
    return not engine_accepts(query) or plain(again.group) != plain(rule.group)
