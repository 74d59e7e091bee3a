"""The modules that a compiled installation has are those of the sources, line by line."""

from __future__ import annotations

import ast
import dataclasses
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from repository import ROOT

DATA = '''"""Data classes of all kinds."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


@dataclass(unsafe_hash=True, slots=True)
class Named:
    """A value with a label that does not count."""

    name: str
    label: str | None = field(default=None, compare=False)


@dataclass(slots=True, eq=False)
class Object:
    """An object with an identity."""

    path: Path
    fields: dict[str, int] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """Return how many fields it has."""
        return len(self.fields)
'''


def _compiler() -> Any:
    spec = spec_from_file_location("hatch_compile", ROOT / "hatch_compile.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


COMPILER = _compiler()
FILES = [ROOT / folder / f"{name}.py" for folder, names in COMPILER.MODULES.items() for name in names.split()]


@pytest.fixture
def data() -> SimpleNamespace:
    """The data classes as they are compiled."""
    found: dict[str, Any] = {"__name__": __name__, "mypyc_attr": lambda **_: lambda cls: cls}  # mypyc alone reads it
    exec(COMPILER.rewritten(DATA), found)  # noqa: S102 - the text above
    return SimpleNamespace(**found)


def _lines(source: str) -> dict[tuple[str, int], int]:
    """Return where functions begin, by name and by the order in which those of a name stand."""
    found: dict[tuple[str, int], int] = {}
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef) and not (node.name.startswith("__") and node.name.endswith("__")):
            found[node.name, sum(name == node.name for name, _ in found)] = node.lineno
    return found


@pytest.mark.parametrize("file", FILES, ids=lambda file: f"{file.parent.name}.{file.stem}")
def test_lines_keep_their_numbers(file: Path) -> None:
    """A traceback of compiled code names the line of the file that is shipped beside it."""
    source = file.read_text("utf-8")
    assert _lines(COMPILER.rewritten(source)) == _lines(source)


def test_equal_data_is_equal(data: SimpleNamespace) -> None:
    """What counts for equality counts in a compiled class, and no more."""
    assert data.Named("a", "x") == data.Named("a", label="y")
    assert hash(data.Named("a")) == hash(data.Named("a", "y"))
    assert data.Named("a") != data.Named("b")
    assert data.Named("a") != "a"


def test_objects_have_an_identity(data: SimpleNamespace) -> None:
    """Objects with the same fields differ, and each has fields of its own."""
    one, other = data.Object(Path()), data.Object(Path())
    one.fields["a"] = 1
    assert one != other
    assert (one.size, other.size) == (1, 0)


def test_fields_are_replaced(data: SimpleNamespace) -> None:
    """`dataclasses.replace` gives a copy with another value."""
    assert dataclasses.replace(data.Named("a", "x"), name="b").label == "x"


def test_a_class_derives_from_compiled_data(data: SimpleNamespace) -> None:
    """A data class that is not compiled adds fields to one that is."""
    made = dataclasses.make_dataclass("Made", [("given", int)], bases=(data.Object,), kw_only=True)(
        path=Path(), given=2
    )
    assert (made.size, made.given) == (0, 2)


def test_a_class_without_room_is_refused() -> None:
    """Where the methods have no lines, no other lines are taken."""
    tight = "@dataclass(unsafe_hash=True)\nclass Tight:\n    a: int\nB = 1\n"
    with pytest.raises(COMPILER.CompileError, match="Tight"):
        COMPILER.rewritten(tight)
