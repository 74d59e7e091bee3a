from __future__ import annotations

from extract.python.programs import unit_of
from hypothesis import given
from hypothesis import strategies as st

KEYWORDS = [
    "if",
    "else",
    "def",
    "class",
    "import",
    "from",
    "for",
    "in",
    "lambda",
    "print",
    "exec",
    "except",
    "global",
    "with",
]
SIGNS = [
    ":",
    "\n",
    "  ",
    "(",
    ")",
    "[",
    "]",
    "=",
    "'a",
    "'",
    '"""',
    "*",
    ".",
    "`",
    ",",
    "\t",
    "{",
    "}",
    "f'",
    "@",
    ":=",
]
TOKENS = st.sampled_from([*KEYWORDS, *SIGNS, "x", "f", "1", "#"])


@given(st.lists(TOKENS, max_size=40))
def test_any_text_can_be_indexed(tokens: list[str]) -> None:
    """No sequence of tokens, however wrong, stops the index."""
    assert unit_of(" ".join(tokens)).module.name == "<module>"


def test_a_branch_without_its_condition_is_passed_over() -> None:
    """An `if` that breaks off before its branch leaves the index whole."""
    assert unit_of("if:").module.bindings == {}


def test_branches_are_numbered() -> None:
    """Bindings know the branches that they stand under, nested ones too."""
    unit = unit_of("if a:\n  if b:\n    x = 1\n  else:\n    x = 2\nelif c:\n  x = 3\nelse:\n  x = 4\n")
    arms = [binding.arms for binding in unit.module.bindings["x"]]
    assert [[number for _, number in arm] for arm in arms] == [[0, 0], [0, 1], [1], [2]]
    assert unit.arm_counts == {0: (3, True), 8: (2, True)}


def test_scopes_hold_what_is_theirs() -> None:
    """Functions, classes, parameters, calls and returns belong to the innermost scope around them."""
    unit = unit_of(
        "class A(B):\n  k = 1\n  def m(self, a, b=2, *c, d: int = 3, **e):\n    self.v = g(a)\n    return h()\n"
        "@deco\ndef f((p, q), r):\n  def inner(): pass\n  return inner\n"
    )
    method = unit.module.classes["A"].functions["m"]
    assert method.receiver == "self"
    assert (method.parameters.positional, method.parameters.rest, method.parameters.keywords) == (
        ["self", "a", "b", "d"], "c", "e",
    )  # fmt: skip
    assert sorted(method.parameters.defaults) == ["b", "d"]
    assert ([call.name for call in method.calls], len(method.returns), list(method.bindings)) == (
        ["g", "h"],
        1,
        ["self.v"],
    )
    outer = unit.module.functions["f"]
    assert (outer.decorators, list(outer.functions), outer.parameters.positional) == (
        ("deco",),
        ["inner"],
        ["(p, q)", "r"],
    )


def test_imports_are_kept_as_written() -> None:
    """Every form of import gives the names that it binds."""
    unit = unit_of("import a.b\nimport c.d as e\nfrom .f import g as h, i\nfrom j.msg import *\n")
    assert {name: (item.module, item.attribute) for name, item in unit.imports.items()} == {
        "a": ("a", None), "e": ("c.d", None), "h": (".f", "g"), "i": (".f", "i"),
    }  # fmt: skip
    assert unit.stars == ["j.msg"]


def test_loop_variables_of_comprehensions_stay_inside() -> None:
    """The variable of a comprehension is bound within it alone."""
    unit = unit_of("[x for x in a]\n")
    [binding] = unit.module.bindings["x"]
    assert binding.within == (0, 14)


def test_very_deep_scopes_belong_to_those_around_them() -> None:
    """Functions deeper than people write are no scopes of their own, and the file says so."""
    unit = unit_of("".join(f"{' ' * depth}def f{depth}():\n" for depth in range(300)) + " " * 300 + "pass\n")
    assert len(unit.scopes) < 60
    assert unit.too_deep == len(unit.scopes)
