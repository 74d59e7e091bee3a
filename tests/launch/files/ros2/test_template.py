from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.launch.files.ros2.actions import Substitution, Text
from kg.launch.files.ros2.template import TemplateError, parse_template

NAMES = st.from_regex(r"[a-z][a-z-]{0,8}", fullmatch=True)
WORDS = st.text("abc/._ '\"$()\\\n:", min_size=1, max_size=8)


def texts(depth: int = 3) -> st.SearchStrategy[Text]:
    """Texts with substitutions nested up to a depth, without adjacent plain parts."""
    plain: st.SearchStrategy[Text] = WORDS.map(lambda word: (word,))
    if depth == 0:
        return plain
    operands = st.lists(texts(depth - 1), max_size=3).map(tuple)
    substitution: st.SearchStrategy[Text] = st.builds(Substitution, NAMES, operands).map(lambda one: (one,))
    pieces: st.SearchStrategy[Text] = st.one_of(plain, substitution)
    return st.lists(pieces, min_size=1, max_size=3).map(joined)


def joined(pieces: list[Text]) -> Text:
    """Join parts like the parser: adjacent plain texts are one part."""
    parts: list[str | Substitution] = []
    for (piece,) in pieces:
        if isinstance(piece, str) and parts and isinstance(parts[-1], str):
            parts[-1] += piece
        else:
            parts.append(piece)
    return tuple(parts)


def printed(text: Text) -> str:
    """Write a text that parses to itself, with every special character escaped."""
    return "".join(
        "".join(f"\\{character}" for character in part)
        if isinstance(part, str)
        else f"$({' '.join((part.kind, *map(printed, part.arguments)))})"
        for part in text
    )


@given(texts())
def test_what_is_written_reads_as_the_same(text: Text) -> None:
    """A text, printed with everything escaped, parses to itself."""
    assert parse_template(printed(text)) == text


@given(st.text("ab $()'\"\\-\n", max_size=40))
def test_any_text_is_parsed_or_refused(text: str) -> None:
    """Any text is parsed, or rejected with the parser's own error."""
    try:
        parts = parse_template(text)
    except TemplateError:
        return
    assert all(isinstance(part, str | Substitution) for part in parts)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", ()),
        ("plain $5", ("plain $5",)),
        ("$(dirname)/x", (Substitution("dirname"), "/x")),
        ("$(env X 'two words')", (Substitution("env", (("X",), ("two words",))),)),
        (
            """$(eval "'$(var a)' == 'b'")""",
            (Substitution("eval", (("'", Substitution("var", (("a",),)), "' == 'b'"),)),),
        ),
        ("$(var $(var a)_x)", (Substitution("var", ((Substitution("var", (("a",),)), "_x"),)),)),
        ("$(var '')", (Substitution("var", ((),)),)),
        ("$(var\n  a)", (Substitution("var", (("a",),)),)),
    ],
)
def test_forms_of_substitutions(text: str, expected: Text) -> None:
    """Operands are separated by spaces or in quotes, and may contain substitutions."""
    assert parse_template(text) == expected


@pytest.mark.parametrize("text", ["$(", "$()", "$(var", "$(var 'a)", "$(var a'b')", "$(eval 1 * (2))", "$(a " * 50])
def test_what_launch_refuses_is_refused(text: str) -> None:
    """A substitution that is not closed, unnamed, or has a quote or a bracket inside a word is an error."""
    with pytest.raises(TemplateError):
        parse_template(text)
