from __future__ import annotations

from extract.cpp.programs import program_of
from hypothesis import given, settings
from hypothesis import strategies as st

GRAPHS = st.dictionaries(st.integers(0, 11), st.sets(st.integers(0, 11), max_size=3), max_size=12)


def reachable(graph: dict[int, set[int]], start: set[int]) -> set[int]:
    """Return all that can be reached from some numbers."""
    seen, pending = set(start), list(start)
    while pending:
        for target in graph.get(pending.pop(), set()) - seen:
            seen.add(target)
            pending.append(target)
    return seen


@settings(max_examples=60, deadline=None)
@given(GRAPHS, st.sets(st.integers(0, 11), max_size=3))
def test_functions_are_reached_as_they_call(graph: dict[int, set[int]], start: set[int]) -> None:
    """What `main` reaches of free functions is the closure of their calls."""
    bodies = "\n".join(
        f"void function{i}() {{ {' '.join(f'function{j}();' for j in sorted(graph.get(i, set())))} }}"
        for i in range(12)
    )
    program = program_of({"main.cpp": f"{bodies}\nint main() {{ {' '.join(f'function{i}();' for i in start)} }}"})
    found = {int(f.name.removeprefix("function")) for f in program.reached if f.name != "main"}
    assert found == reachable(graph, start)


def names(source: str, **more: str) -> set[str]:
    """Return the qualified names of what a program reaches."""
    files = {name.replace("__", "."): text for name, text in more.items()}
    return {"::".join((*f.scope, f.name)) for f in program_of({"main.cpp": source, **files}).reached}


def test_methods_of_classes_never_made_are_not_reached() -> None:
    """A method is reached only when its class is mentioned, whatever other class has one of that name."""
    source = "struct A { void go() {} }; struct B { void go() {} }; int main() { A a; a.go(); }"
    assert names(source) == {"main", "A::go"}


def test_overrides_are_reached_through_the_base() -> None:
    """A method that overrides one of a base class in the build is reached with its class."""
    source = "struct A { virtual void go() = 0; }; struct B : A { void go() {} void stay() {} }; int main() { B b; }"
    assert names(source) == {"main", "B::go"}


def test_bases_outside_of_the_build_may_call_anything() -> None:
    """All methods of a class with a base that is not in the build are reached."""
    source = "struct B : outside::Base { void go() {} }; int main() { B b; }"
    assert names(source) == {"main", "B::go"}


def test_members_are_made_with_their_class() -> None:
    """The class of a member is live with the class that has it; names of methods alone reach nothing."""
    source = "struct A { A() {} void never() {} }; struct B { A a; }; int main() { B b; }"
    assert names(source) == {"main", "A::A"}


def test_classes_of_one_name_are_told_apart() -> None:
    """Of several classes with one name the one in the same file is meant."""
    source = '#include "a.hpp"\nstruct Impl { Impl() {} }; int main() { Impl impl; }'
    other = "#include <ros/ros.h>\nnamespace other { struct Impl { void Impl2() {} Impl() {} }; }"
    assert names(source, a__hpp=other) == {"main", "Impl::Impl"}


def test_headers_lead_to_their_sources() -> None:
    """A class that is declared in a header brings the file that defines its methods."""
    source = '#include "a.hpp"\nint main() { A a; a.go(); }'
    files = {"main.cpp": source, "a.hpp": "struct A { void go(); };", "a.cpp": '#include "a.hpp"\nvoid A::go() {}'}
    assert {f.name for f in program_of(files).reached} == {"main", "go"}


def test_friends_are_not_made() -> None:
    """A class that is only named as a friend is not live."""
    source = "struct F { F() {} }; struct A { friend struct F; A() {} }; int main() { A a; }"
    assert names(source) == {"main", "A::A"}
