"""C++ sources are prepared for the grammar with all byte positions preserved."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.extract.cpp.preparing import prepared
from kg.extract.cpp.syntax import parse

PIECES = (
    "#if A", "#ifdef B", "#ifndef C", "#elif D", "#else", "#endif", "#if 0", "#if __has_include(<a.h>)", "{", "}",
    "} else {", "if (x) {", "Q_OBJECT", "public Q_SLOTS:", "Q_SIGNALS:", "X_PUBLIC void f();", "#define X_PUBLIC y",
    "class X_API A : B {",
    "connect(a, SIGNAL(b(int)), c, SLOT(d(\nbool)));", "int a;",
)  # fmt: skip


@given(st.lists(st.sampled_from(PIECES), max_size=12))
def test_every_byte_stays_at_its_place(pieces: list[str]) -> None:
    """Removed text becomes spaces: no byte moves, and line ends remain."""
    source = "\n".join(pieces).encode()
    found = prepared(source, 2)
    assert len(found) == len(source)
    assert [at for at, one in enumerate(found) if one == ord("\n")] == [
        at for at, one in enumerate(source) if one == ord("\n")
    ]


@pytest.mark.parametrize(
    "source",
    [
        "void f() {\n#if A\n  if (x) {\n#else\n  if (y) {\n#endif\n  }\n}\n",
        "void f() {\n  if (x) {\n#if A\n  } else if (y) {\n#endif\n  } else {\n  }\n}\n",
        "void f() {\n#if A\n  if (x)\n#else\n  if (y)\n#endif\n  {\n  }\n}\n",
        "void f() {\n  if (x)\n#if A\n    g();\n#else\n    h();\n#endif\n}\n",
        "#if __has_include(<a.hpp>)\n#include <a.hpp>\n#else\n#include <a.h>\n#endif\nint a;\n",
        "class A : B\n{\nQ_OBJECT\npublic:\nexplicit A(int a);\npublic Q_SLOTS:\nvoid b();\nQ_SIGNALS:\nvoid c();\n};",
        "class A\n{\npublic:\n  A_PUBLIC\n  explicit A(int a);\n  A_LOCAL void b();\n};\n",
        "void f() { connect(a, SIGNAL(b(int)), c, SLOT(d(bool))); }\n",
    ],
    ids=["sides of a block", "branches", "heads", "body", "has_include", "Qt", "visibility", "signals"],
)
def test_what_only_a_preprocessor_understands_is_read(source: str) -> None:
    """The grammar finds an error in the source, and none in the prepared text."""
    assert parse(source.encode()).root_node.has_error
    assert not parse(prepared(source.encode(), 2)).root_node.has_error


def test_directives_stay() -> None:
    """A macro definition is unchanged."""
    source = b'#define A_PUBLIC __attribute__((visibility("default")))\n#define A_LOCAL int\n'
    assert prepared(source, 2) == source


@pytest.mark.parametrize(
    ("source", "compiled"),
    [
        ("#define A 1\n#if A\nleft;\n#else\nright;\n#endif\n", "left"),
        ("#ifndef A_H\n#define A_H\n#define A 0\n#if A\nleft;\n#else\nright;\n#endif\n#endif\n", "right"),
        ("#ifndef A\n#define A 1\n#endif\n#if A\nleft;\n#else\nright;\n#endif\n", "left right"),
        ("#define A 1\n#ifdef B\n#undef A\n#endif\n#if A\nleft;\n#else\nright;\n#endif\n", "left right"),
        ("#define A 1\n#if 0\n#define A 0\n#endif\n#if A\nleft;\n#else\nright;\n#endif\n", "left"),
        ("#if A\nleft;\n#else\nright;\n#endif\n#define A 1\n", "left right"),
    ],
    ids=["defined", "behind a guard", "default", "perhaps undefined", "not compiled", "defined later"],
)
def test_macros_that_a_file_defines_select_sides(source: str, compiled: str) -> None:
    """A branch is removed if an unconditionally defined macro excludes it."""
    found = prepared(source.encode(), 2).decode()
    assert " ".join(word for word in ("left", "right") if word in found) == compiled
