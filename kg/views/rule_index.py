"""The index of rules: families with counts, and the rules of one family or with some words.

It parses only the rules that it returns. The view `rules` parses all and computes their dependencies.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RuleError, UnknownNameError
from kg.pipeline.reasoning import digest, rules_in_force
from kg.rules.authoring.manual import documentation
from kg.rules.files import Documentation
from kg.similar import did_you_mean
from kg.store.opening import layout_of
from kg.views.rules import costs_of, listed, problem_texts, rule_object, run_object

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kg.rules.authoring.library import Entry
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

OWN: Final = "own"
"""Name of the family of rules that are in no folder of their own."""


def rule_index(snapshot: EmbeddedSnapshot, settings: Settings, family: str = "", text: str = "") -> dict[str, Any]:
    """Return the families of rules with counts, and the rules of a family that contain all words of `text`.

    `families` lists `family`, `in_force` (whether any rule of it is), and the number of its `rules`, of those that
    `run` and that `report` findings; of the last run of all rules, `fired` (how many derived something), `derived` and
    `seconds`, which are None where that is not known. `rules` are objects as in the view `rules`, without `sections`;
    there are none without `family` and `text`. Words are searched in names, titles and documentation. `all` is the
    number of all rules; `run` is as in the view `rules`. `problems` are errors of rules that cannot be read, as texts.

    Raises:
        UnknownNameError: KG001 with suggestions, for a family that does not exist.
    """
    mark = digest(settings)
    library, costs = listed(settings, mark), costs_of(settings)
    families: dict[str, list[Entry]] = defaultdict(list)
    for entry in library.entries.values():
        families[entry.family or OWN].append(entry)
    if family and family not in families:
        hint = did_you_mean(family, families) or f"Families: {', '.join(sorted(families))}."
        raise UnknownNameError("KG001", f"unknown family of rules `{family}`", hint=hint)
    texts = {entry.name: _documentation(entry) for entry in library.entries.values()}
    chosen = [*families[family]] if family else [*library.entries.values()] if text else []
    words = text.lower().split()
    shown = [entry for entry in chosen if _contains(entry, texts[entry.name], words)]
    broken = list(library.problems)
    rules_in_force(settings, broken, cache=layout_of(settings).cache)
    return {
        "families": [_family(name, members, texts, costs) for name, members in sorted(families.items())],
        "rules": [
            {key: value for key, value in rule_object(library, entry, costs).items() if key != "sections"}
            for entry in shown
        ],
        "all": len(library.entries),
        "run": run_object(snapshot, settings, costs, len(library.in_force)),
        "problems": list(dict.fromkeys(problem_texts(broken))),
    }


def _documentation(entry: Entry) -> Documentation:
    """Return the documentation of a rule; empty where it cannot be read."""
    try:
        return documentation(entry)
    except RuleError:
        return Documentation()


def _contains(entry: Entry, documented: Documentation, words: Iterable[str]) -> bool:
    """Return whether the name, title and documentation of a rule contain all words, in lower case."""
    text = " ".join((entry.name, documented.title, *documented.sections.values())).lower()
    return all(word in text for word in words)


def _family(
    name: str, entries: list[Entry], texts: Mapping[str, Documentation], costs: Mapping[str, Any]
) -> dict[str, Any]:
    measured = [costs[entry.name] for entry in entries if entry.name in costs]
    return {
        "family": name,
        "in_force": any(entry.in_force for entry in entries),
        "rules": len(entries),
        "run": sum(entry.in_force for entry in entries),
        "report": sum(bool(texts[entry.name].severity) for entry in entries),
        "fired": sum(1 for _, derived, _ in measured if derived) if measured else None,
        "derived": sum(derived for _, derived, _ in measured) if measured else None,
        "seconds": sum(seconds for seconds, _, _ in measured) if measured else None,
    }
