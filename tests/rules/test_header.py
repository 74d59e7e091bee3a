from __future__ import annotations

import pytest

from kg.errors import RuleError
from kg.rules.files import parse_header

HEADER = """\
# Nodes publish topics
#
# ## What it infers
#
# One triple:
#
#     node publishes topic
#
# ## Why
# To ask in one step.
#
# since: 0.2
# severity: warning

# not part of it
CONSTRUCT { } WHERE { }
"""


def test_a_header_has_title_sections_and_keys() -> None:
    """Title, sections without comment signs, version and severity are read from the first comments."""
    found = parse_header(HEADER, "x.rq")
    assert found.title == "Nodes publish topics"
    assert found.sections == {
        "What it infers": "One triple:\n\n    node publishes topic",
        "Why": "To ask in one step.",
    }
    assert (found.since, found.severity) == ("0.2", "warning")


@pytest.mark.parametrize("text", ["", "CONSTRUCT { } WHERE { }\n# late", "\n\nRULE { } WHERE { }"])
def test_a_rule_without_comments_before_it_has_no_documentation(text: str) -> None:
    """Comments after the first statement are not documentation."""
    found = parse_header(text, "x.rq")
    assert (found.title, found.sections, found.since, found.severity) == ("", {}, None, None)


@pytest.mark.parametrize(
    ("text", "place", "message", "hint"),
    [
        ("# T\n# ## Wy", "2:3", "unknown heading `Wy`", "Did you mean `Why`?"),
        ("# T\n# ## Author", "2:3", "unknown heading `Author`", "The headings are"),
        ("# T\n# ## Why\n# a\n# ## Why", "4:3", "the heading `Why` appears twice", "Join"),
        ("# T\n# severity: warn", "2:3", "unknown severity `warn`", "Did you mean `warning`?"),
        ("# T\n# severity: catastrophe!", "2:3", "unknown severity `catastrophe!`", "The severities are"),
        ("# T\n# since:", "2:3", "`since:` has no value", "0.2"),
    ],
)
def test_a_malformed_header_is_refused(text: str, place: str, message: str, hint: str) -> None:
    """An unknown heading or severity is reported with its place and a suggestion (KG206)."""
    with pytest.raises(RuleError, match=message) as caught:
        parse_header(text, "x.rq")
    assert caught.value.code == "KG206"
    assert str(caught.value.place) == f"x.rq:{place}"
    assert caught.value.hint is not None
    assert hint in caught.value.hint
