from __future__ import annotations

import itertools
import math
import os
import pathlib
from typing import TYPE_CHECKING

import pytest
from extract.python.programs import plain, values_of
from hypothesis import given
from hypothesis import strategies as st

from kg.facts import Resolution
from kg.holes import Hole
from kg.symbolic.values import Mapping, Number, Sequence, Text

if TYPE_CHECKING:
    from hypothesis.strategies import SearchStrategy

WORDS = st.text("abz/_~ %{}'\"\\\nä0", max_size=6)
PLAIN = st.text("abz/_0", min_size=1, max_size=4)
NUMBERS = st.integers(-20, 300)


def percent_escaped(text: str) -> str:
    """Return a text that `%` formatting reproduces."""
    return text.replace("%", "%%")


def brace_escaped(text: str) -> str:
    """Return a text that `str.format` reproduces."""
    return text.replace("{", "{{").replace("}", "}}")


def combine(inner: SearchStrategy[str]) -> SearchStrategy[str]:
    """Return expressions made of smaller ones."""
    pairs = st.tuples(inner, inner)
    return st.one_of(
        pairs.map(lambda two: f"({two[0]} + {two[1]})"),
        st.tuples(WORDS, inner, NUMBERS).map(
            lambda three: f"({percent_escaped(three[0]) + '%s-%03d'!r} % ({three[1]}, {three[2]}))"
        ),
        st.tuples(WORDS, inner).map(lambda two: f"({percent_escaped(two[0]) + '%(k)s'!r} % {{'k': {two[1]}}})"),
        st.tuples(WORDS, inner, NUMBERS).map(
            lambda three: f"{brace_escaped(three[0]) + '{}{:>4}'!r}.format({three[1]}, {three[2]})"
        ),
        pairs.map(lambda two: f"'{{b}}/{{a}}'.format(a={two[0]}, b={two[1]})"),
        pairs.map(lambda two: f"'{{1}}{{0}}'.format({two[0]}, {two[1]})"),
        st.tuples(PLAIN, PLAIN, NUMBERS).map(lambda three: f'f"{three[0]}{{{three[1]!r}}}{{{three[2]}:+d}}{{{{}}}}"'),
        st.tuples(PLAIN, inner, inner).map(lambda three: f"{three[0]!r}.join([{three[1]}, {three[2]}])"),
        inner.map(lambda one: f"{one}.strip('/').lower()"),
        pairs.map(lambda two: f"({two[0]} if 1 == 1 else {two[1]})"),
        pairs.map(lambda two: f"({two[0]} or {two[1]})"),
        pairs.map(lambda two: f"[{two[0]}, {two[1]}][-1]"),
        pairs.map(lambda two: f"{{'k': {two[0]}, 'l': {two[1]}}}['l']"),
        inner.map(lambda one: f"str({one})"),
    )


EXPRESSIONS = st.recursive(WORDS.map(repr), combine, max_leaves=6)


@given(EXPRESSIONS)
def test_string_expressions_are_what_python_makes_of_them(expression: str) -> None:
    """An expression of constants evaluates to the same string as in Python."""
    computed = eval(expression)  # noqa: S307 - Python itself is the reference, on expressions made above
    assert [plain(value) for value in values_of(f"x = {expression}\n")] == [computed]


@pytest.mark.parametrize("left", ["'a'", "''", "5", "0", "True", "False", "None"])
def test_a_known_left_side_decides_or(left: str) -> None:
    """`or` gives its left side if that is known to be true, its right side if it is known to be false."""
    computed = eval(f"{left} or 'right'")  # noqa: S307 - Python itself is the reference
    assert [plain(value) for value in values_of(f"x = {left} or 'right'\n")] == [computed]


def test_an_unknown_left_side_of_or_leaves_both() -> None:
    """A partly known value can be either side."""
    values = values_of("import sys\nx = 'a' + sys.argv[1] or 'right'\n")
    assert [plain(value) for value in values] == [None, "right"]


@given(st.lists(st.tuples(PLAIN, PLAIN), min_size=1, max_size=5, unique_by=lambda pair: pair[0]))
def test_loops_give_every_round(pairs: list[tuple[str, str]]) -> None:
    """A loop over a literal list assigns its variables in each iteration, and keeps those of one together."""
    [value] = values_of(f"x = []\nfor a, b in {pairs!r}:\n    x.append(a + ':' + b)\n")
    assert isinstance(value, Sequence)
    assert [plain(item) for item in value.items] == [f"{one}:{other}" for one, other in pairs]


@given(st.lists(PLAIN, max_size=5), st.integers(-3, 3))
def test_python_s_own_functions_are_computed(words: list[str], start: int) -> None:
    """`enumerate`, `zip`, `range`, `len`, `dict` and comprehensions of known values are known."""
    listing = f"[str(i) + w + str(n) for i, (w, n) in enumerate(zip({words!r}, range(len({words!r}))), {start})]"
    computed = eval(listing)  # noqa: S307 - Python itself is the reference, on expressions made above
    [value] = values_of(f"x = {listing}\n")
    assert isinstance(value, Sequence)
    assert [plain(item) for item in value.items] == computed


@pytest.mark.parametrize(
    "expression",
    [
        "int('12') + abs(-3)", "float('1.5') * 2", "1.0 * 2", "7 // 2", "6 / 3", "str(0.5 + 0.5)", "-1.5", "bool([])",
        "'ab' * 3", "'a' == 1", "1 == 1.0", "[1, 'a'] == [1, 'a']", "[1] == [1, 2]", "'%5.2f|%s' % (1.25, True)",
        "f'{1.5:.3f}{\"a\"!r}{2!s:>4}'", "'{0!r}'.format('x')", "str(None)", "'a,b,c'.rsplit(',', 1)[1]",
        "'a.b'.partition('.')[2]", "'aXb'.swapcase()", "'abc'.find('c')", "'12'.isdigit()", "'a b'.split()[1]",
        "sorted(['b', 'a'])[0]", "sorted([3, 1], reverse=True)[0]", "list(reversed([1, 2]))[0]", "sum([1, 2, 3])",
        "max([1, 5, 2])", "min(4, 2)", "all([1, 'a'])", "any([0, ''])", "list('abc')[1]", "[*['a', 'b'], 'c'][1]",
        "{**{'a': 1}, 'b': 2, **{'a': 3}}['a']", "(lambda *a, k='d': k)('x', 'y')", "[1, 2, 3, 4][1:3][0]",
    ],
)  # fmt: skip
def test_operations_are_what_python_makes_of_them(expression: str) -> None:
    """Numbers keep their type, and functions and methods of Python give its results."""
    computed = eval(expression)  # noqa: S307 - Python itself is the reference, on the expressions above
    [value] = values_of(f"x = {expression}\n")
    assert plain(value) == computed
    assert not isinstance(value, Number) or value.floating == isinstance(computed, float)


@pytest.mark.parametrize(
    "expression",
    [
        "os.path.dirname('/a/b/c')", "os.path.basename('a/b.py')", "os.path.normpath('/a/../b')",
        "os.path.splitext('a/b.yaml')[1]", "os.path.join('a', '/b')", "str(pathlib.Path('a') / 'b' / 'c.txt')",
        "pathlib.Path('/a/b.c').stem", "str(pathlib.Path('/a/b.c').parent)", "pathlib.Path('a/b.c').suffix",
        "str(pathlib.Path('a').joinpath('b'))", "str(pathlib.Path('a/b.c').with_suffix('.d'))",
        "list(itertools.chain([1], [2]))[1]", "list(itertools.product('ab', 'cd'))[3][0]", "math.pi",
    ],
)  # fmt: skip
def test_modules_of_python_are_computed(expression: str) -> None:
    """Paths, `itertools` and `math` of known values are known."""
    imports = "import os, pathlib, itertools, math\n"
    computed = eval(expression, {"os": os, "pathlib": pathlib, "itertools": itertools, "math": math})  # noqa: S307 - the reference
    assert [plain(value) for value in values_of(f"{imports}x = {expression}\n")] == [computed]


@pytest.mark.parametrize(
    ("text", "known"),
    [
        ("x = 'a'\nx += '/b'\n", ["a/b"]),
        ("x = y = 'a'\n", ["a"]),
        ("(a, (b, x)) = ('1', ('2', '3'))\n", ["3"]),
        ("x = 'a'\nif c:\n    x = 'b'\n", ["b", "a"]),
        ("if c:\n    x = 'a'\nelif d:\n    x = 'b'\nelse:\n    x = 'c'\n", ["c", "b", "a"]),
        ("if c:\n    a, b = '1', '2'\nelse:\n    a, b = '3', '4'\nx = a + b\n", ["34", "12"]),
        ("try:\n    x = 'a'\nexcept ValueError:\n    x = 'b'\n", ["b", "a"]),
        ("d = {}\nd['k'] = 'v'\nx = d['k']\n", ["v"]),
        ("l = []\nl.append('a')\nl.append('b')\nx = l[1]\n", ["b"]),
        ("def f(a, b='d', *c, **e):\n    return a + b + e['k']\nx = f('1', k='2')\n", ["1d2"]),
        ("def f(a):\n    if a:\n        return 'y'\n    return 'n'\nx = f(False)\n", ["n"]),
        ("class A:\n    n = 'c'\n    def __init__(self, p):\n        self.p = p\nx = A('q').p + A('r').n\n", ["qc"]),
        ("class A:\n    @property\n    def p(self):\n        return 'v'\nx = A().p\n", ["v"]),
        ("class A:\n def m(s): return 'a'\nclass B(A):\n def m(s): return super().m() + 'b'\nx = B().m()\n", ["ab"]),
        ("import os\nx = os.path.join('a', 'b', 'c/')\n", ["a/b/c/"]),
        ("x = None or 'a'\n", ["a"]),
        ("x = getattr(__import__('a'), 'b', 'c')\n", [None]),
        ("def f():\n    global x\n    x = 'g'\nf()\n", ["g"]),
        ("with 'w' as x:\n    pass\n", ["w"]),
        ("x = (y := 'a') + y\n", ["aa"]),
        ("a, *b = ['1', '2', '3']\nx = b[1]\n", ["3"]),
        ("*a, x = ['1', '2', '3']\n", ["3"]),
        ("d = {'a': '1', 'b': '2'}\ndel d['a']\nx = list(d)[0]\n", ["b"]),
        ("l = ['a', 'b', 'a']\nx = l.pop() + str(len(l))\n", ["a2"]),
        ("def f(l):\n    l.append('b')\nl = ['a']\nf(l)\nx = l[1]\n", ["b"]),
        ("def f(l):\n    l = l + ['b']\nl = ['a']\nf(l)\nx = str(len(l))\n", ["1"]),
        ("from collections import defaultdict\nd = defaultdict(list)\nd['k'].append('v')\nx = d['k'][0]\n", ["v"]),
        ("m = 'b'\nmatch m:\n    case 'a' | 'b':\n        x = 'c'\n    case _:\n        x = 'd'\n", ["c"]),
        ("m = 'e'\nmatch m:\n    case 'a':\n        x = 'c'\n    case n if n == 'e':\n        x = n\n", ["e"]),
        ("from dataclasses import dataclass\n@dataclass\nclass A:\n    p: str\n    q: str\nx = A('1', '2').q\n", ["2"]),
    ],
)  # fmt: skip
def test_bindings(text: str, known: list[str | None]) -> None:
    """Names have the values of the bindings that reach them, branch by branch."""
    assert sorted(map(str, map(plain, values_of(text)))) == sorted(map(str, known))


def test_what_is_not_known_stays_a_hole() -> None:
    """Unknown parts are holes in a string; none is guessed."""
    [value] = values_of("x = 'robot_%s/%s' % (unknown(), 'scan')\n")
    assert isinstance(value, Text)
    assert (value.parts, value.resolution) == (("robot_", Hole(), "/scan"), Resolution.PARTIAL)


def test_parameters_keep_their_name() -> None:
    """The value of `rospy.get_param` is its default, with the name of the parameter."""
    [value] = values_of("import rospy\nx = rospy.get_param('~topic', 'scan')\n")
    assert value == Text.of("scan", Resolution.CONSTANT, "~/topic") or value == Text.of(
        "scan", Resolution.PARAMETER_DEFAULT, "~/topic"
    )


def test_dictionaries_keep_the_values_of_one_unknown_key_together() -> None:
    """Two uses of an unknown key refer to the same entry."""
    text = "d = {'a': {'n': '1', 't': '2'}, 'b': {'n': '3', 't': '4'}}\ne = d[k]\nx = e['n'] + e['t']\n"
    assert [plain(value) for value in values_of(text)] == ["12", "34"]


@pytest.mark.parametrize("text", ["x = x\n", "def f(): return f()\nx = f()\n", "a = b\nb = a\nx = a\n", "x = f(x)\n"])
def test_circles_end(text: str) -> None:
    """A value that depends on itself is unknown."""
    assert all(not isinstance(value, Mapping) and plain(value) is None for value in values_of(text))


def test_depth_and_breadth_are_bounded() -> None:
    """Deep nesting and many alternatives give an unknown value, without an error."""
    deep = "x = " + "str(" * 3000 + "'a'" + ")" * 3000 + "\n"
    assert [plain(value) for value in values_of(deep)] == [None]
    wide = "".join(f"if c{n}:\n    a{n} = '1'\nelse:\n    a{n} = '0'\n" for n in range(20))
    assert 0 < len(values_of(wide + "x = " + " + ".join(f"a{n}" for n in range(20)) + "\n")) <= 64


def test_pairs_of_an_empty_collection_have_unknown_elements() -> None:
    """`enumerate` of an empty list runs no iteration."""
    assert values_of("x = 'kept'\nfor i, y in enumerate([], start=n):\n    x = y\n")[0] == Text(("kept",))


SHARED = [
    ("def f(out): out.append('b')\nx = ['a']\nf(x)", ["a", "b"]),
    ("def f(out): out += ['b']\nx = ['a']\nf(x)", ["a", "b"]),
    ("def f(out): out.extend(['b'])\nx = ['a']\nf(out=x)", ["a", "b"]),
    ("def f(out): g(out)\ndef g(to): to.append('b')\nx = ['a']\nf(x)", ["a", "b"]),
    (
        "class A:\n  def __init__(self):\n    self.all = ['a']\n    f(self.all)\ndef f(o): o.append('b')\nx = A().all",
        ["a", "b"],
    ),
    ("def f(n, out):\n  for one in n: out.append(one)\nx = []\nf(['a', 'b'], x)", ["a", "b"]),
    ("def f(out): out['k'] = 'b'\nd = {'k': 'a'}\nf(d)\nx = [d['k']]", ["b"]),
    ("def f(out): out = ['b']\nx = ['a']\nf(x)", ["a"]),
    ("def f(out):\n  out = list(out)\n  out.append('b')\nx = ['a']\nf(x)", ["a"]),
    ("def f(out):\n  for out in ['b']: pass\nx = ['a']\nf(x)", ["a"]),
    ("def f(out): out += 'b'\nt = 'a'\nf(t)\nx = [t]", ["a"]),
    ("def f(*out): out.append('b')\nx = ['a']\nf(*x)", ["a"]),
]


@pytest.mark.parametrize(("text", "wanted"), SHARED)
def test_functions_change_the_lists_and_dictionaries_that_they_get(text: str, wanted: list[str]) -> None:
    """A change of the object affects the caller; an assignment to the parameter does not."""
    (found,) = values_of(text)
    assert isinstance(found, Sequence)
    assert [plain(one) for one in found.items] == wanted
