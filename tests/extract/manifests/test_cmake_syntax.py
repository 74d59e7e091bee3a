from __future__ import annotations

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from kg.extract.manifests.cmake_syntax import Argument, Block, Command, SyntaxFault, parse, parse_commands


@pytest.mark.parametrize(
    ("text", "texts", "forms"),
    [
        ("f()", [], ""),
        ("f(a b\n\tc)", ["a", "b", "c"], "uuu"),
        ('f("a b" "")', ["a b", ""], "qq"),
        (r'f("say \"hi\"")', [r"say \"hi\""], "q"),
        ('f("one\\\ntwo")', ["onetwo"], "q"),
        ("f([[a ${b} ]] ]=])", ["a ${b} ", "]=]"], "bu"),
        ("f([==[\na]]b]==])", ["a]]b"], "b"),
        ("f(a;b)", ["a;b"], "u"),
        ('f(-Da="b c" $(MAKE))', ['-Da="b c"', "$(MAKE)"], "uu"),
        (r"f(a\ b \( \#)", [r"a\ b", r"\(", r"\#"], "uuu"),
        ("f(a (b (c)) d)", ["a", "(", "b", "(", "c", ")", ")", "d"], "upupuppu"),
        ('f(a # comment ) "\n b #[[ c ) ]] d)', ["a", "b", "d"], "uuu"),
        ("f($<TARGET_FILE:x> ${a${b}} $ENV{HOME})", ["$<TARGET_FILE:x>", "${a${b}}", "$ENV{HOME}"], "uuu"),
    ],
)
def test_arguments(text: str, texts: list[str], forms: str) -> None:
    """Arguments of every form of cmake-language(7) are distinguished; comments are skipped."""
    arguments = parse_commands(text)[0].arguments
    assert [argument.text for argument in arguments] == texts
    assert "".join(argument.form[0] for argument in arguments) == forms


def test_commands_and_lines() -> None:
    """Commands are in lower case with their first line, each argument with its own."""
    text = "# first\nSET(a\n  b)\r\n#[=[ two\nlines ]=] Project (x)\n"
    assert parse_commands(text) == [
        Command("set", (Argument("a", "unquoted"), Argument("b", "unquoted")), 2),
        Command("project", (Argument("x", "unquoted"),), 5),
    ]


@pytest.mark.parametrize(
    ("text", "line", "commands"),
    [
        ("set(a b)\nset(c", 2, 1),
        ("set(a)\n)", 2, 1),
        ("set(a)\n\nnot a command\n", 3, 1),
        ('set(a "open)\n', 1, 0),
        ("\x00\x01", 1, 0),
    ],
)
def test_faults(text: str, line: int, commands: int) -> None:
    """A syntax error is reported with its line; earlier commands remain."""
    statements, faults = parse(text)
    assert [fault.line for fault in faults] == [line]
    assert len(statements) == commands


def test_blocks() -> None:
    """Compound commands contain their bodies, an `if` all its branches."""
    statements, faults = parse("if(A)\nset(x)\nelseif(B)\nelse()\nforeach(y)\nset(z)\nendforeach()\nendif()\nset(end)")
    assert faults == []
    block, last = statements
    assert isinstance(block, Block)
    assert isinstance(last, Command)
    assert [(command.name, len(body)) for command, body in block.branches] == [("if", 1), ("elseif", 0), ("else", 1)]


@pytest.mark.parametrize(
    ("text", "line"), [("if(A)\nset(x)\n", 1), ("set(x)\nendif()\n", 2), ("macro(a)\nendif()", None)]
)
def test_unbalanced_blocks(text: str, line: int | None) -> None:
    """An unclosed or unopened block is an error; another name in the closing command is accepted."""
    assert [fault.line for fault in parse(text)[1]] == ([] if line is None else [line])


def test_nesting_without_end() -> None:
    """5,000 nested blocks and parentheses are parsed without recursion."""
    statements, faults = parse("if(A)\n" * 5000 + "endif()\n" * 5000)
    assert (len(statements), faults) == (1, [])
    assert len(parse_commands("f(" + "(" * 5000 + ")" * 5000 + ")")[0].arguments) == 10_000


PLAIN = st.text(st.characters(blacklist_categories=["Cs"], blacklist_characters="\r\0"), max_size=20)


def quote(text: str) -> str:
    """Write text as a quoted argument."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def bracket(text: str) -> str:
    """Write text as a bracket argument of a length that it does not contain."""
    level = next("=" * n for n in range(len(text) + 2) if "]" + "=" * n not in text)
    return f"[{level}[\n{text}]{level}]"


@example(["\\\n"], "\n")
@given(st.lists(PLAIN, max_size=6), st.sampled_from(["\n", " ", "\t", " # c\n", "#[[ x ]]"]))
def test_round_trip(texts: list[str], gap: str) -> None:
    """Any texts written as quoted or bracket arguments are parsed back unchanged."""
    quoted = parse_commands(f"f({gap}{gap.join(map(quote, texts))}{gap})")[0].arguments
    expected = [text.replace("\\", "\\\\").replace('"', '\\"') for text in texts]
    assert [argument.text for argument in quoted] == expected
    brackets = parse_commands(f"f({gap.join(map(bracket, texts))})")[0].arguments
    assert [argument.text for argument in brackets] == texts


@given(st.text(alphabet='fset()[]="\\#$<>{}; \n\tifendmacro', max_size=120))
def test_any_text(text: str) -> None:
    """Any text is parsed or has errors, which lie within it."""
    for fault in parse(text)[1]:
        assert isinstance(fault, SyntaxFault)
        assert 1 <= fault.line <= text.count("\n") + 1
