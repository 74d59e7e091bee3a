from __future__ import annotations

import string
from dataclasses import dataclass

import pytest
from extract.cpp.packages import interfaces_of, publisher_of, texts_of
from hypothesis import given, settings
from hypothesis import strategies as st

from kg.facts import Resolution

WORDS = st.text(string.ascii_letters + string.digits + '/_~ "\\', max_size=8)
NAMES = st.text(string.ascii_letters + string.digits + "/_", min_size=1, max_size=8)


@dataclass(frozen=True)
class Spelled:
    """An expression with its declarations in the function, and at namespace scope."""

    code: str
    value: str
    local: str = ""
    outer: str = ""


def quoted(text: str) -> str:
    """Return a C++ literal."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def leaf(kind: str, name: str, text: str, number: int) -> Spelled:
    """Spell a text as literal, constant, local variable, member or macro, or a number as text."""
    literal = quoted(text)
    return {
        "place": Spelled(f"std::string({literal})", text),
        "constant": Spelled(name, text, local=f"const std::string {name} = {literal};"),
        "constructed": Spelled(name, text, local=f"std::string {name}({literal});"),
        "assigned": Spelled(name, text, local=f"std::string {name}; {name} = {literal};"),
        "global": Spelled(name, text, outer=f"static const std::string {name} = {literal};"),
        "named": Spelled(f"space::{name}", text, outer=f"namespace space {{ const std::string {name}{{{literal}}}; }}"),
        "macro": Spelled(f"std::string({name.upper()})", text, outer=f"#define {name.upper()} {literal}"),
        "member": Spelled(
            f"{name}.text", text, f"Held_{name} {name};", f"struct Held_{name} {{ std::string text = {literal}; }};"
        ),
        "pointed": Spelled(
            f"{name}->text",
            text,
            f"auto {name} = std::make_shared<Held_{name}>({literal});",
            f"struct Held_{name} {{ explicit Held_{name}(std::string t) : text(t) {{}} std::string text; }};",
        ),
        "number": Spelled(f"std::to_string({number})", str(number)),
        "variable": Spelled(f"std::to_string({name})", str(number), local=f"int {name} = {number};"),
    }[kind]


KINDS = (
    *("place", "constant", "constructed", "assigned", "global", "named", "macro"),
    *("member", "pointed", "number", "variable"),
)


@st.composite
def sums(draw: st.DrawFn, prefix: str = "a", words: st.SearchStrategy[str] = WORDS) -> Spelled:
    """Spell a concatenation of leaves, in place, with `+=`, with `append`, in a stream or through a function."""
    drawn = draw(st.lists(st.tuples(st.sampled_from(KINDS), words, st.integers(0, 999)), min_size=1, max_size=5))
    parts = [leaf(kind, f"{prefix}{i}", text, number) for i, (kind, text, number) in enumerate(drawn)]
    local = " ".join(part.local for part in parts)
    outer = "\n".join(part.outer for part in parts if part.outer)
    value = "".join(part.value for part in parts)
    name = f"{prefix}sum"
    way = draw(st.sampled_from(["plus", "append", "call", "stream", "lambda"]))
    if way == "plus":
        return Spelled(" + ".join(part.code for part in parts), value, local, outer)
    if way == "append":
        steps = " ".join(f"{name} += {part.code};" for part in parts[:-1])
        return Spelled(name, value, f"{local} std::string {name}; {steps} {name}.append({parts[-1].code});", outer)
    if way == "stream":
        steps = " << ".join(part.code for part in parts)
        return Spelled(f"{name}.str()", value, f"{local} std::stringstream {name}; {name} << {steps};", outer)
    taken = ", ".join(f"const std::string& p{i}" for i in range(len(parts)))
    body = " + ".join(f"p{i}" for i in range(len(parts)))
    called = f"{name}({', '.join(part.code for part in parts)})"
    if way == "lambda":
        return Spelled(called, value, f"{local} auto {name} = [&]({taken}) {{ return {body}; }};", outer)
    return Spelled(called, value, local, f"{outer}\nstd::string {name}({taken}) {{ return {body}; }}")


@settings(max_examples=80, deadline=None)
@given(sums())
def test_texts_are_what_the_program_would_compute(spelled: Spelled) -> None:
    """Concatenations of literals, constants, members, locals and results evaluate to their run-time value."""
    assert texts_of(spelled.code, spelled.local, spelled.outer) == {spelled.value}


@settings(max_examples=40, deadline=None)
@given(sums(words=NAMES), sums("b", NAMES), st.sampled_from(["choice", "branch", "return", "switch"]))
def test_both_branches_are_alternatives(one: Spelled, other: Spelled, way: str) -> None:
    """A text that depends on an unknown condition has the values of both branches, and no others."""
    local, outer = one.local + other.local, f"{one.outer}\n{other.outer}"
    code = {
        "choice": f"argc > 1 ? {one.code} : {other.code}",
        "branch": "chosen",
        "return": "pick()",
        "switch": "chosen",
    }[way]
    local += {
        "choice": "",
        "branch": f"std::string chosen; if (argc > 1) {{ chosen = {one.code}; }} else {{ chosen = {other.code}; }}",
        "return": f"auto pick = [&]() -> std::string {{ if (argc > 1) return {one.code}; return {other.code}; }};",
        "switch": f"std::string chosen; switch (argc) "
        f"{{ case 1: chosen = {one.code}; break; default: chosen = {other.code}; }}",
    }[way]
    assert texts_of(code, local, outer) == {one.value, other.value}


@settings(max_examples=40, deadline=None)
@given(st.integers(-50, 50), st.integers(-50, 50), st.integers(1, 9), st.sampled_from("+-*"))
def test_numbers_are_computed(one: int, other: int, third: int, sign: str) -> None:
    """Arithmetic of known numbers follows C++."""
    expected = {"+": one + third + other, "-": one - third - other, "*": one * third * other}[sign]
    assert texts_of("std::to_string(b)", f"int a = ({one}); int b = a {sign} {third} {sign} ({other});") == {
        str(expected)
    }


@pytest.mark.parametrize(
    ("expression", "local", "shown"),
    [
        ("std::to_string(k)", "int k = 2.7;", "2"),
        ("std::to_string(k)", "int k; k = 2.7;", "2"),
        ("std::to_string(static_cast<int>(2.7))", "", "2"),
        ("std::to_string((int) 2.7)", "", "2"),
        ("std::to_string(0x10)", "", "16"),
        ("std::to_string(r)", "double r = 0.5;", "0.500000"),
    ],
)
def test_numbers_have_the_form_of_their_type(expression: str, local: str, shown: str) -> None:
    """A whole number has no fraction, and `std::to_string` writes decimal digits, six of them after a point."""
    assert texts_of(expression, local) == {shown}


def test_what_is_not_known_is_said() -> None:
    """A call of an unknown function leaves a hole, with a reason that names it."""
    (found,) = interfaces_of(publisher_of('"a/" + foreign()'))
    assert (found.name, found.resolution) == ("/a/{foreign}", Resolution.PARTIAL)
    assert "foreign" in (found.reason or "")


def test_recursion_ends() -> None:
    """Evaluation of a recursive function, and of a variable defined by itself, terminates."""
    assert texts_of('f("b")', outer='std::string f(std::string s) { return f(s + "a"); }') <= {None, "{}"}
    assert len(texts_of("g", outer='std::string g = g + "a";')) == 1


@pytest.mark.parametrize(("opening", "closing"), [("(", ")"), ("f(", ")"), ("1 + (", ")"), ("-", "")])
def test_deep_nesting_ends(opening: str, closing: str) -> None:
    """Excessively nested expressions do not overflow the stack, and later code is still read."""
    assert texts_of('"x"', f"auto deep = {opening * 3000}1{closing * 3000};") == {"x"}


def test_alternatives_are_bounded() -> None:
    """Multiplying alternatives end in unknown names, with the reason."""
    choices = "".join(f'std::string s{i} = argc > {i} ? "a{i}" : "b{i}"; ' for i in range(12))
    found = interfaces_of(publisher_of(" + ".join(f"s{i}" for i in range(12)), choices))
    assert len(found) <= 64


def test_a_variable_is_no_literal() -> None:
    """A text read from a variable is a constant, one in place a literal."""
    (place,) = interfaces_of('int main() { ros::NodeHandle nh; nh.advertise<std_msgs::String>("a", 1); }')
    (variable,) = interfaces_of(
        'int main() { ros::NodeHandle nh; auto s = "a"; nh.advertise<std_msgs::String>(s, 1); }'
    )
    assert (place.resolution, variable.resolution) == (Resolution.LITERAL, Resolution.CONSTANT)


def test_objects_are_no_texts() -> None:
    """An object of a class is an unknown text, with its class as the reason."""
    source = "struct A {}; int main() { A a; ros::NodeHandle nh; nh.advertise<std_msgs::String>(a, 1); }"
    (found,) = interfaces_of(source)
    assert (found.name, found.resolution) == (None, Resolution.UNRESOLVED)
    assert found.reason


@pytest.mark.parametrize("known", [("a",), ("a", "b")])
def test_braces_of_a_constructor_hold_the_elements_of_a_list(known: tuple[str, ...]) -> None:
    """A member initialised with one text in braces is a list of one element."""
    written = ", ".join(f'"{one}"' for one in known)
    outer = f"struct Names {{ Names() : all{{{written}}} {{}} std::vector<std::string> all; }};"
    local = "Names names; for (size_t i = 0; i != names.all.size(); i++)"
    assert texts_of("names.all[i]", local, outer) == set(known)


def test_a_word_from_a_stream_is_not_known() -> None:
    """The former value of its variable is discarded."""
    local = 'std::string word; std::stringstream words(argv[1]); while (words >> word) { name = word + "/map"; }'
    assert texts_of("name", 'std::string name = "none"; ' + local) == {"none", "{argv[1]}/map"}
