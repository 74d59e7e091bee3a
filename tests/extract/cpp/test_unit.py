from __future__ import annotations

from extract.cpp.programs import unit_of
from hypothesis import given
from hypothesis import strategies as st

from kg.extract.cpp.unit import included


@given(st.lists(st.sampled_from(["a.h", "b/c.hpp", "x/msg/y.hpp"]), max_size=6))
def test_includes_are_read_in_order(paths: list[str]) -> None:
    """Every include line gives its path, in quotes or angle brackets."""
    lines = [f'  #  include "{p}"  // why' if i % 2 else f"#include <{p}>" for i, p in enumerate(paths)]
    source = "#pragma once\n" + "\n".join(lines) + "\n#define INCLUDE 1\nint a;\n"
    assert included(source.encode()) == paths


def test_functions_know_where_they_belong() -> None:
    """A function has the scopes of the namespaces, classes and qualifiers around it."""
    source = (
        "namespace a { namespace b { void f() {} class C { void m() {} struct D { void n() {} }; }; } }\n"
        "void a::b::C::o() {}\ntemplate <class T> void a::E<T>::p() {}\nint main() {}"
    )
    found = {function.name: "::".join(function.scope) for function in unit_of(source).functions}
    assert found == {"f": "a::b", "m": "a::b::C", "n": "a::b::C::D", "o": "a::b::C", "p": "a::E", "main": ""}


def test_words_in_comments_and_texts_are_no_code() -> None:
    """A name is found where it is code, and nowhere else."""
    source = '// name\n/* name */ int main() { auto name_1 = "name"; name(name); }\n#if 0\nint name;\n#endif\n'
    assert [node.start_point.row for node in unit_of(source).occurrences("name")] == [1, 1]


def test_classes_list_members_with_types_and_defaults() -> None:
    """The fields of a class are its members by name, methods that are only declared among them."""
    (cls,) = unit_of("int main() {}\nclass A : B, public c::D<int> { int x = 1, *y; void f(); E e{2}; };").classes
    assert sorted(cls.fields) == ["e", "f", "x", "y"]
    assert [base.text for base in cls.bases] == [b"B", b"c::D<int>"]
    default = cls.fields["x"][1]
    assert default is not None
    assert default.text == b"1"


def test_what_looks_like_a_function_is_read_as_arguments() -> None:
    """`Foo foo(bar);` is a construction: its argument keeps its place."""
    unit = unit_of("int main() { Foo foo(bar, *b, c::d); }")
    declarator = unit.occurrences("foo")[0].parent
    assert declarator is not None
    parameters = declarator.child_by_field_name("parameters")
    listed = unit.reparse(parameters) if parameters is not None else []
    assert [unit.source[node.start_byte : node.end_byte] for node in listed] == [b"bar", b"*b", b"c::d"] or (
        declarator.type == "init_declarator"
    )
