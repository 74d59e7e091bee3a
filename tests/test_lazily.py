"""Names that are imported when they are used (`kg.lazily`)."""

from __future__ import annotations

import ast
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import pytest
from repository import modules

from kg.lazily import Lazy, loaded

if TYPE_CHECKING:
    from collections.abc import Iterator

LENDER = """
class Base:
    kind = "base"

    @classmethod
    def made(cls):
        return cls()

def double(number):
    return 2 * number

def count():
    return 7
"""
BORROWER = """
from kg.lazily import lazily

with lazily():
    from lender_of_tests import things
    from lender_of_tests.things import Base, count, double as twice

def doubled(number):
    return twice(number)

def derived():
    class Derived(Base):
        pass
    return Derived()

def is_base(value):
    return isinstance(value, Base)

def kind():
    return things.Base.kind + Base.made().kind
"""


@pytest.fixture
def borrower(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return a module that imports names of another one lazily."""
    folder = tmp_path / "lender_of_tests"
    folder.mkdir()
    (folder / "__init__.py").write_text("")
    (folder / "things.py").write_text(LENDER)
    (tmp_path / "borrower_of_tests.py").write_text(BORROWER)
    monkeypatch.syspath_prepend(tmp_path)
    for name in ("borrower_of_tests", "lender_of_tests", "lender_of_tests.things"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    yield import_module("borrower_of_tests")
    for name in ("borrower_of_tests", "lender_of_tests", "lender_of_tests.things"):
        sys.modules.pop(name, None)


def test_a_module_is_imported_when_a_name_is_used(borrower: Any) -> None:
    """Not before."""
    assert "lender_of_tests.things" not in sys.modules
    assert (borrower.doubled(4), borrower.count()) == (8, 7)
    assert "lender_of_tests.things" in sys.modules


def test_classes_can_be_derived_from_and_checked(borrower: Any) -> None:
    """A lazy class stands for the class."""
    assert borrower.is_base(borrower.derived())
    assert not borrower.is_base(4)


def test_attributes_of_modules_and_classes_are_theirs(borrower: Any) -> None:
    """Also those of a module that is imported from its package."""
    assert borrower.kind() == "basebase"


def test_what_replaces_a_name_is_used(borrower: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """A name is looked up at each use."""
    assert borrower.doubled(4) == 8
    monkeypatch.setattr("lender_of_tests.things.double", lambda number: -number)
    assert borrower.doubled(4) == -4


def test_imports_of_others_are_as_usual(borrower: Any) -> None:
    """What another module imports meanwhile is imported at once."""
    folder = Path(borrower.__file__).parent
    (folder / "lender_of_tests" / "user.py").write_text("from lender_of_tests.things import double\n")
    (folder / "other_of_tests.py").write_text(
        "from importlib import import_module\nfrom kg.lazily import lazily\n\n"
        "with lazily():\n    user = import_module('lender_of_tests.user')\n"
    )
    assert import_module("other_of_tests").user.double(4) == 8


def test_a_name_that_is_not_there_is_an_import_error() -> None:
    """The error names the module, as for a usual import."""
    with pytest.raises(ModuleNotFoundError, match=r"kg\.errors"):
        loaded(Lazy("kg.errors", "no_such_name"))


def test_lazy_names_of_kg_are_modules_functions_and_classes() -> None:
    """Constants do not work, and exceptions cannot be caught."""
    found = [one for module in modules("kg") for one in _postponed(module.tree)]
    assert found
    for lazy in found:
        value = loaded(lazy)
        assert isinstance(value, ModuleType) or callable(value), lazy
        assert not (isinstance(value, type) and issubclass(value, BaseException)), lazy


def _postponed(tree: ast.Module) -> Iterator[Lazy]:
    """Yield the names that a module imports lazily."""
    for block in tree.body:
        if isinstance(block, ast.With) and ast.unparse(block.items[0].context_expr) == "lazily()":
            for statement in block.body:
                assert isinstance(statement, ast.Import | ast.ImportFrom)
                for alias in statement.names:
                    module = getattr(statement, "module", None)
                    yield Lazy(module, alias.name) if module else Lazy(alias.name)
