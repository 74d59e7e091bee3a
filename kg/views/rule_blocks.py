"""Rules made of blocks: their text, its problems, and what it would infer. Nothing is written."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import msgspec

from kg.errors import Place, RuleError, UsageError
from kg.pipeline.reasoning import check_context, digest, explained_vocabulary, rules_in_force, schema_of
from kg.rules.authoring.library import Library
from kg.rules.authoring.starting import find_rule
from kg.rules.blocks.read import read
from kg.rules.blocks.tree import FAMILY, Rule
from kg.rules.blocks.write import Written, write
from kg.rules.checks.finding import Context, Finding, from_error
from kg.rules.checks.firing import StoreOf
from kg.rules.checks.run import check_file, with_rules
from kg.rules.explain.view import View
from kg.rules.files import RuleFile, RuleSet
from kg.rules.reading import read_text
from kg.rules.stratify import failures
from kg.views.arguments import whole
from kg.views.complete import cache_of
from kg.views.evidence import places
from kg.views.rule_trial import examples, trial
from kg.views.why_tree import Telling

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

_SECONDS: Final = 3.0  # how long the store is asked whether a rule matches anything
_MOST: Final = 200  # so many of the facts that a rule would infer are shown at most
_LAST: Final[dict[tuple[str, str], Context]] = {}
"""What rules were checked against last, by the digest of the rules and the snapshot."""


def blocks_check(  # noqa: PLR0913 - a rule in one of two forms, and the extent of the answer
    snapshot: EmbeddedSnapshot,
    settings: Settings,
    *,
    rule: Mapping[str, Any] | None = None,
    text: str = "",
    name: str = "",
    brief: str = "",
) -> dict[str, Any]:
    """Return a rule, given as blocks or as the `text` of the rule `name`, in both forms, and its problems.

    The keys: `rule` (blocks, `kg.rules.blocks.tree`; None for a text that cannot be shown as blocks), `text`, and
    `findings`, as of `kg rules check`: `code`, `severity`, `message`, `hint`, `line`, `column`, `lacks`, what is
    missing of the documentation by the names of `Rule`'s members, and `id`, the block that it is about, where there is
    one. A rule without examples is not a finding here. With `brief` (any text) there are only the findings that keep a
    text from being read, which takes no time.

    Raises UsageError: KG003 for malformed blocks.
    """
    shown, written, problem = _given(rule, text, name)
    called = shown.name if shown else name or f"{FAMILY}/rule"
    source = written.text if written else text
    problems = [problem] if problem else [] if brief else list(_findings(snapshot, settings, source, called))
    return {
        "rule": shown,
        "text": source,
        "findings": [_finding_object(one, written) for one in problems],
    }


def blocks_open(snapshot: EmbeddedSnapshot, settings: Settings, *, name: str) -> dict[str, Any]:  # noqa: ARG001 - every view is given one
    """Return an available rule as blocks: `rule`, and its `text`.

    Raises:
        UnknownNameError: KG001 with suggestions.
        RuleError: KG209 for a rule that blocks cannot show, and KG2xx for one that cannot be read.
    """
    library = Library.of(settings)
    entry = find_rule(library, name)
    file = library.read(entry.name)
    if file.notation != ".rq":
        hint = f"`kg rules compile {entry.name} --to rq` writes it as one."
        raise RuleError("KG209", f"{entry.name} is not a SPARQL CONSTRUCT rule", hint=hint)
    blocks = read(file.text, entry.name, str(file.path))
    return {"rule": blocks, "text": file.text}


def blocks_try(  # noqa: PLR0913 - a rule in one of two forms, and the extent of the answer
    snapshot: EmbeddedSnapshot,
    settings: Settings,
    *,
    rule: Mapping[str, Any] | None = None,
    text: str = "",
    name: str = "",
    limit: str | int = 50,
) -> dict[str, Any]:
    """Return what a rule would infer on this store, applied once to all that the store has, inferences among it.

    The keys: `facts`, at most `limit`: those of `kg.views.why` (`subject`, `predicate`, `object`, `text`) with `known`
    (whether the store has it already), `bindings`, `premises` (facts with their evidence) and `conditions`; `looked`,
    how many were found, and `fresh`, how many of them are new; `whole`, whether these are all that there are, for
    matches are looked for during some seconds only; `recursive`, whether the rule reads what it derives, so that
    running it gives more; `examples`, a page of examples for `kg rules test` made of the first fact, empty where there
    is none; `seconds`.

    Raises:
        UsageError: KG003 for malformed blocks.
        RuleError: KG2xx for a rule that cannot be run.
    """
    begin = time.perf_counter()
    shown, written, _ = _given(rule, text, name)
    file = _read(written.text if written else text, shown.name if shown else name or f"{FAMILY}/rule")
    view = View(snapshot, explained_vocabulary(settings), file.rules, prefixes=file.prefixes)
    most = min(max(whole(str(limit), 50), 1), _MOST)
    tried = trial(view, file, most)
    telling = Telling(view, RuleSet((file,)), places(snapshot), settings.base)
    return {
        "facts": [{**telling.application(one.fact, one.derivation), "known": one.known} for one in tried.facts],
        "looked": tried.looked,
        "whole": tried.whole,
        "fresh": tried.fresh,
        "recursive": tried.recursive,
        "examples": examples(file, tried.facts),
        "seconds": round(time.perf_counter() - begin, 3),
    }


def _given(rule: Mapping[str, Any] | None, text: str, name: str) -> tuple[Rule | None, Written | None, Finding | None]:
    """Return the blocks, their text, and what keeps the text from being shown as blocks."""
    if rule is not None:
        try:
            shown = msgspec.convert(rule, Rule)
        except (msgspec.ValidationError, RecursionError) as error:
            raise UsageError("KG003", f"invalid blocks of a rule: {error}") from None
        return shown, write(shown), None
    called = name or f"{FAMILY}/rule"
    try:
        shown = read(text, called, _path(called).name)
    except RuleError as error:
        return None, None, from_error(error, called, Place(called, 1, 1))
    return shown, None, None


def _path(name: str) -> Path:
    return Path("rules", f"{name}.rq")


def _read(text: str, name: str) -> RuleFile:
    return read_text(text, _path(name), name)


def _findings(snapshot: EmbeddedSnapshot, settings: Settings, text: str, name: str) -> list[Finding]:
    try:
        file = _read(text, name)
    except RuleError as error:
        return [from_error(error, name, Place(str(_path(name)), 1, 1))]
    context = _context(snapshot, settings)
    others = (one for one in context.rules.files if one.name != name)
    context = with_rules(RuleSet((*others, file)), context)
    # Why the rules cannot be put in order because of this one.
    cycles = [
        from_error(failure.error, name, failure.rule.place)
        for failure in failures(context.cut)
        if any(rule.name == name for rule in failure.cycle)
    ]
    return [*cycles, *(one for one in check_file(file, context) if one.code != "KG219")]


def _context(snapshot: EmbeddedSnapshot, settings: Settings) -> Context:
    """Return what rules are checked against; what of it is the same for a snapshot and the rules at hand is kept.

    Which terms the store uses is known from the statistics of completion, for all of a large store is not read here.
    """
    key = (digest(settings), snapshot.identity)
    if key not in _LAST:
        fresh = check_context(settings, None)
        _LAST.clear()
        _LAST[key] = replace(fresh, seconds=_SECONDS, rules=rules_in_force(settings, []), schema=schema_of(snapshot))
    used = cache_of(snapshot, settings).cached_statistics()
    store = StoreOf(View(snapshot, explained_vocabulary(settings)))
    context = _LAST[key]
    return replace(context, terms=context.terms.union(used.classes, used.properties), store=store)


def _finding_object(finding: Finding, written: Written | None) -> dict[str, Any]:
    line = finding.place.line
    return {
        "code": finding.code,
        "severity": finding.severity,
        "message": finding.message,
        "hint": finding.hint,
        "line": line,
        "column": finding.place.column,
        "lacks": finding.lacks,
        "id": written.lines.get(line or 0) if written else None,
    }
