"""KG214: a rule whose body matches without any data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.query.runner import DeadlineError, in_thread
from kg.rules.checks.finding import Finding, at_rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.rules.checks.finding import Context
    from kg.rules.files import RuleFile

__all__ = ["CODE", "TITLE", "check"]

CODE: Final = "KG214"
TITLE: Final = "always fires"


def check(file: RuleFile, context: Context) -> Iterator[Finding]:
    """Yield one finding for a file that has a rule that an empty store satisfies."""
    empty = context.empty
    if empty is None:
        return
    try:
        fires = in_thread(lambda: any(empty.matches(rule.body) for rule in file.rules), context.seconds)
    except DeadlineError:
        return  # rows of VALUES alone may be too many to join; their results are unknown
    if fires:
        message = "the rule fires whatever the data are: an empty store satisfies its body"
        hint = "State facts in an ontology or in DATA, or add what the rule should depend on."
        yield Finding(CODE, "warning", file.name, message, at_rule(file), hint)
