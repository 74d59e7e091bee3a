from __future__ import annotations

import string
from dataclasses import dataclass

from extract.cpp.programs import evaluator_of, texts_of, values_of
from hypothesis import given, settings
from hypothesis import strategies as st

from kg.extract.values import Number, Text, Unknown
from kg.facts import Resolution

WORDS = st.text(string.ascii_letters + string.digits + '/_~ "\\', max_size=8)


@dataclass(frozen=True)
class Spelled:
    """An expression with the declarations that it needs before it in a function, and at namespace scope."""

    code: str
    value: str
    local: str = ""
    outer: str = ""


def quoted(text: str) -> str:
    """Return a C++ literal."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def leaf(kind: str, name: str, text: str, number: int) -> Spelled:
    """Spell a text as literal, constant, local variable or macro, or a number as text."""
    literal = quoted(text)
    return {
        "place": Spelled(f"std::string({literal})", text),
        "constant": Spelled(name, text, local=f"const std::string {name} = {literal};"),
        "constructed": Spelled(name, text, local=f"std::string {name}({literal});"),
        "assigned": Spelled(name, text, local=f"std::string {name}; {name} = {literal};"),
        "global": Spelled(name, text, outer=f"static const std::string {name} = {literal};"),
        "named": Spelled(f"space::{name}", text, outer=f"namespace space {{ const std::string {name}{{{literal}}}; }}"),
        "macro": Spelled(f"std::string({name.upper()})", text, outer=f"#define {name.upper()} {literal}"),
        "number": Spelled(f"std::to_string({number})", str(number)),
        "variable": Spelled(f"std::to_string({name})", str(number), local=f"int {name} = {number};"),
    }[kind]


KINDS = ("place", "constant", "constructed", "assigned", "global", "named", "macro", "number", "variable")


@st.composite
def sums(draw: st.DrawFn, prefix: str = "a") -> Spelled:
    """Spell a concatenation of leaves, in place, with `+=`, with `append`, in a stream or through a function."""
    drawn = draw(st.lists(st.tuples(st.sampled_from(KINDS), WORDS, st.integers(0, 999)), min_size=1, max_size=5))
    parts = [leaf(kind, f"{prefix}{i}", text, number) for i, (kind, text, number) in enumerate(drawn)]
    local = " ".join(part.local for part in parts)
    outer = "\n".join(part.outer for part in parts if part.outer)
    value = "".join(part.value for part in parts)
    name = f"{prefix}sum"
    way = draw(st.sampled_from(["plus", "append", "call", "stream"]))
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
    function = f"std::string {name}({taken}) {{ return {body}; }}"
    return Spelled(f"{name}({', '.join(part.code for part in parts)})", value, local, f"{outer}\n{function}")


@settings(max_examples=150, deadline=None)
@given(sums())
def test_texts_are_what_the_program_would_compute(spelled: Spelled) -> None:
    """Concatenations of literals, constants, locals and results evaluate to what running them gives."""
    source = f"{spelled.outer}\nint main() {{ {spelled.local} use({spelled.code}); }}"
    assert texts_of(source) == [spelled.value]


@settings(max_examples=60, deadline=None)
@given(sums(), sums("b"))
def test_both_branches_are_alternatives(one: Spelled, other: Spelled) -> None:
    """A conditional has the values of both of its sides."""
    local, outer = one.local + other.local, f"{one.outer}\n{other.outer}"
    code = f"argc > 1 ? {one.code} : {other.code}"
    found = texts_of(f"{outer}\nint main(int argc, char** argv) {{ {local} use({code}); }}")
    assert set(found) == {one.value, other.value}


@settings(max_examples=60, deadline=None)
@given(st.integers(-50, 50), st.integers(-50, 50), st.integers(1, 9), st.sampled_from("+-*"))
def test_numbers_are_computed(one: int, other: int, third: int, sign: str) -> None:
    """Arithmetic of known numbers is done as C++ does it."""
    source = f"int main() {{ int a = ({one}); use(a {sign} {third} {sign} ({other})); }}"
    expected = {"+": one + third + other, "-": one - third - other, "*": one * third * other}[sign]
    (found,) = values_of(evaluator_of(source))
    assert isinstance(found, Number) or "(-" in source
    if isinstance(found, Number):
        assert found.value == expected


def test_what_is_not_known_is_said() -> None:
    """A call of a function that is not in the sources leaves a hole, with the reason."""
    (found,) = values_of(evaluator_of('int main() { use("a/" + foreign()); }'))
    assert isinstance(found, Text)
    assert found.pattern == "a/{}"
    assert found.reason == "foreign() is not in the sources that were read"


def test_recursion_ends() -> None:
    """A function that calls itself, and a variable that is made of itself, come to an end."""
    function = 'std::string f(std::string s) { return f(s + "a"); } int main() { use(f("b")); }'
    variable = 'std::string g = g + "a"; int main() { use(g); }'
    assert texts_of(function) == [None]
    assert texts_of(variable) == [None]


def test_alternatives_are_bounded() -> None:
    """Choices that multiply end in one alternative that is not known."""
    choices = "".join(f'std::string s{i} = argc > {i} ? "a{i}" : "b{i}"; ' for i in range(12))
    total = " + ".join(f"s{i}" for i in range(12))
    found = values_of(evaluator_of(f"int main(int argc, char** argv) {{ {choices} use({total}); }}"))
    assert len(found) <= 65


def test_a_variable_is_no_literal() -> None:
    """A text read from a variable counts as constant, one in place as literal."""
    (place,) = values_of(evaluator_of('int main() { use("a"); }'))
    (variable,) = values_of(evaluator_of('int main() { auto s = "a"; use(s); }'))
    assert isinstance(place, Text)
    assert isinstance(variable, Text)
    assert (place.resolution, variable.resolution) == (Resolution.LITERAL, Resolution.CONSTANT)


def test_objects_are_no_texts() -> None:
    """An object of a class is not known as a text, and says what it is."""
    (found,) = values_of(evaluator_of("struct A {}; int main() { A a; use(a); }"))
    assert isinstance(found, Unknown)
