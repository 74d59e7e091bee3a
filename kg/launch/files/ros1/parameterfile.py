"""YAML of `<rosparam>`: one parameter for each leaf, with the line that it is on.

Source: wiki.ros.org/rosparam, "YAML Format" with its `deg(180)` and `rad(2*pi)`. Aliases can mean far more than they
say; what a document means in all is bounded.
"""

from __future__ import annotations

import datetime as dt
import json
import math
import re
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import yaml

from kg.extract.python.evaluation import HOLE, Dialect, ExpressionError, UnsupportedError, evaluate_text
from kg.holes import ANONYMOUS
from kg.yamltext import LOADER, Walk, YamlFault, compose_yaml, fault_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.facts import LaunchPlugin

MOST_CHARACTERS: Final = 1 << 16
"""Of one text after substitution; arguments that repeat each other double with each line."""

_ROSLAUNCH: Final = "/roslaunch/"
"""The node that sets parameters; a private name that reaches the server is private to it."""


def shown(text: str) -> str:
    """Return the text as facts have it, with `{}` for unknown parts."""
    return text.replace(HOLE, ANONYMOUS)


def join(namespace: str, name: str) -> str:
    """Return `name` in a namespace (with or without a slash at its end); private and global names keep their own."""
    if name.startswith(("~", "/")) or not namespace:
        return name
    return f"~{name}" if namespace == "~" else f"{namespace.rstrip('/')}/{name}"


def canonical(name: str) -> str:
    """Return an absolute name with single slashes and none at its end, as the parameter server has it."""
    rooted = f"{_ROSLAUNCH}{name[1:]}" if name.startswith("~") else name
    return "/" + "/".join(part for part in rooted.split("/") if part)


def global_namespace(name: str) -> str:
    """Return a namespace as an absolute one with a slash at its end."""
    inner = canonical(name)
    return inner if inner == "/" else f"{inner}/"


_PLAIN: Final = re.compile(r"[A-Za-z_/][\w./-]*(?: [\w./-]+)*", re.ASCII)
_RESOLVER: Final = yaml.resolver.Resolver()
_TEXT: Final = "tag:yaml.org,2002:str"
_BOOLEANS: Final = {"true": True, "1": True, "false": False, "0": False}
_SCALARS: Final = ((bool, "bool"), (int, "int"), (float, "double"), (str, "string"))


def automatic(text: str) -> bool | int | float | str:
    """Return the value that roslaunch guesses: a number, a boolean, else the text."""
    try:
        if "." in text:
            return float(text)
        if "_" not in text:
            return int(text)
    except ValueError:
        pass
    lower = text.lower()
    return lower == "true" if lower in {"true", "false"} else text


def truth(text: str) -> bool:
    """Return the truth value of the text of an `if` in roslaunch; ValueError if it has none."""
    value = _BOOLEANS.get(text.lower().strip())
    if value is None:
        raise ValueError(f"'{text}' is neither true nor false")
    return value


def converted(text: str, kind: str) -> object:
    """Return the value of a text of the type `kind` (`auto`, `str`, `int`, `double`, `bool`), else ValueError."""
    if kind == "auto":
        return automatic(text)
    if kind in {"str", "string"}:
        return text
    if kind == "int":
        return int(text)
    if kind == "double":
        return float(text)
    if kind in {"bool", "boolean"}:
        return truth(text)
    raise ValueError(f"'{kind}' is not a type of a parameter")


def type_of(value: object) -> str | None:
    """Return the ROS type of a value: `bool`, `int`, `double`, `string`, `int_array`, ...; None for null."""
    if isinstance(value, list):
        kinds = {type_of(item) for item in value}
        if kinds == {"int", "double"}:
            return "double_array"
        return f"{kinds.pop()}_array" if len(kinds) == 1 and kinds <= {name for _, name in _SCALARS} else "array"
    if isinstance(value, dict):
        return "struct"
    if isinstance(value, bytes):
        return "base64"
    if isinstance(value, dt.date):
        return "date"
    return next((name for kind, name in _SCALARS if isinstance(value, kind)), None)


def one_line(value: object) -> str:
    """Return a value as YAML in one line that means the same."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        if value != value:  # noqa: PLR0124 - this is what makes a number none
            return ".nan"
        if value in {float("inf"), float("-inf")}:
            return ".inf" if value > 0 else "-.inf"
        mantissa, exponent, power = repr(value).partition("e")
        # YAML 1.1 takes `1e-05` for a string
        return f"{mantissa}.0e{power}" if exponent and "." not in mantissa else f"{mantissa}{exponent}{power}"
    if isinstance(value, list):
        return f"[{', '.join(map(one_line, value))}]"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{one_line(key)}: {one_line(item)}' for key, item in value.items())}}}"
    return _string(value) if isinstance(value, str) else str(value)


def _string(text: str) -> str:
    tag = _RESOLVER.resolve(yaml.ScalarNode, text, (True, False))  # type: ignore[no-untyped-call]  # has no types
    return text if tag == _TEXT and _PLAIN.fullmatch(text) else json.dumps(text, ensure_ascii=False)


MOST_TEXT: Final = 1 << 20
"""Characters of a parameter file; far beyond what people write."""
_MOST_VALUE: Final = 4096
"""Characters of one value; robot descriptions are of no use in a graph."""
_CACHED: Final = 1 << 18
_MERGE: Final = "tag:yaml.org,2002:merge"
_STRING: Final = "tag:yaml.org,2002:str"


@dataclass(frozen=True, slots=True)
class Leaf:
    """A value in a tree of parameters; `keys` lead to it from the top, `line` is that of its key, counted from 1."""

    keys: tuple[str, ...]
    line: int
    value: str | None
    type: str | None
    reason: str | None = None
    plugins: tuple[LaunchPlugin, ...] = ()
    """Those of the robot description that the value is."""


@dataclass(frozen=True, slots=True)
class ParameterTree:
    """The leaves of a document, and problems as message and line."""

    leaves: tuple[Leaf, ...] = ()
    problems: tuple[tuple[str, int], ...] = ()
    is_mapping: bool = True
    is_empty: bool = False
    """There is no document, which is null."""
    too_large: bool = False


class _Loader(LOADER):  # type: ignore[misc]  # one of two classes, by what the YAML package was built with
    """YAML as rosparam takes it."""


for _unit in ("deg", "rad"):
    _Loader.add_implicit_resolver(f"!{_unit}", re.compile(rf"^{_unit}\([^)]*\)$"), list(f"{_unit}("))


def read_tree(text: str) -> ParameterTree:
    """Return the parameters of a YAML document; what is before an error of its meaning is kept."""
    if len(text) > MOST_TEXT:
        return ParameterTree(problems=((f"the file is longer than {MOST_TEXT} characters", 1),), too_large=True)
    return _cached(text) if len(text) <= _CACHED else _cached_large(text)


def read_scalar(text: str) -> object:
    """Return the value of a YAML text in one line; the text itself when it is none."""
    try:
        return read_value(text) if len(text) <= _MOST_VALUE else text
    except ValueError:
        return text


def read_value(text: str) -> object:
    """Return the value of a YAML text; `ValueError` for one that is wrong or too large."""
    if len(text) > MOST_TEXT:
        raise YamlFault(f"is longer than {MOST_TEXT} characters", is_large=True)
    return _Walk().value(compose_yaml(text, _Loader), 0)


def leaf_of(value: object, line: int = 1, keys: tuple[str, ...] = ()) -> Leaf:
    """Return the leaf for a value; None with the reason when it is not known or too long."""
    kind = type_of(value)
    if isinstance(value, bytes):
        return Leaf(keys, line, None, kind, "it is binary")
    if value == HOLE:
        return Leaf(keys, line, None, None, "it depends on an unknown value")
    try:
        written = shown(one_line(value))
    except ValueError:
        return Leaf(keys, line, None, kind, "the number is too large")
    if len(written) > _MOST_VALUE:
        return Leaf(keys, line, None, kind, f"it has more than {_MOST_VALUE} characters")
    return Leaf(keys, line, written, kind)


def _read(text: str) -> ParameterTree:
    walk, leaves = _Walk(), []
    try:
        root = compose_yaml(text, _Loader)
        if root is None:
            return ParameterTree(is_empty=True)
        for leaf in walk.leaves(root, (), root.start_mark.line + 1, 0):
            leaves.append(leaf)  # noqa: PERF402 - what came before an error is kept
    except YamlFault as fault:
        before = "; the parameters before that were read" if fault.is_large else ""
        problem = (f"the text {fault.message}{before}", fault.line or 1)
        return ParameterTree(tuple(leaves), (*walk.problems, problem), too_large=fault.is_large)
    return ParameterTree(tuple(leaves), tuple(walk.problems), is_mapping=isinstance(root, yaml.MappingNode))


_cached: Final = lru_cache(maxsize=512)(_read)
_cached_large: Final = lru_cache(maxsize=1)(_read)
"""Of large files only the last one is kept: it is often loaded for several nodes in a row."""


class _Walk(Walk):
    """One walk over a composed document."""

    def __init__(self) -> None:
        super().__init__()
        self.problems: list[tuple[str, int]] = []
        self._constructor = yaml.constructor.SafeConstructor()

    def leaves(self, node: yaml.Node, keys: tuple[str, ...], line: int, depth: int) -> Iterator[Leaf]:
        """Yield the leaves of a node that `keys` lead to."""
        self.visit(node, depth)
        if isinstance(node, yaml.MappingNode):
            for key, (inner, where) in self._mapping(node, depth).items():
                if isinstance(key, str):
                    yield from self.leaves(inner, (*keys, key), where, depth + 1)
                else:
                    self.problems.append((f"the key {one_line(key)} is not text; roslaunch refuses it", where))
            return
        try:
            yield leaf_of(self.value(node, depth), line, keys)
        except YamlFault:
            raise
        except ValueError as error:
            self.problems.append((f"the value is wrong: {error}", line))

    def value(self, node: yaml.Node | None, depth: int) -> object:
        """Return the value of a node; ValueError when it is none of its tag."""
        if node is None:
            return None
        self.visit(node, depth)
        if isinstance(node, yaml.MappingNode):
            pairs = self._mapping(node, depth)
            return {key: self.value(inner, depth + 1) for key, (inner, _) in pairs.items()}
        if isinstance(node, yaml.SequenceNode):
            return [self.value(item, depth + 1) for item in node.value]
        if not isinstance(node, yaml.ScalarNode):
            return None
        if node.tag in {"!deg", "!rad", "!degrees", "!radians"}:
            return _angle(node.value, node.tag)
        if node.tag == _STRING:
            return str(node.value)
        if len(node.value) > _MOST_VALUE:
            raise ValueError(f"it has more than {_MOST_VALUE} characters")
        self._constructor.constructed_objects.clear()
        try:
            value: object = self._constructor.construct_object(node)
        except yaml.YAMLError as error:
            raise fault_of(error) from error
        return value

    def _mapping(self, node: yaml.MappingNode, depth: int) -> dict[object, tuple[yaml.Node, int]]:
        """Return the pairs of a mapping with the lines of their keys; of two alike the later, merged ones first."""
        merged: dict[object, tuple[yaml.Node, int]] = {}
        own: dict[object, tuple[yaml.Node, int]] = {}
        for key, inner in node.value:
            self.visit(key, depth)
            if key.tag == _MERGE:
                for one in reversed(inner.value if isinstance(inner, yaml.SequenceNode) else [inner]):
                    if isinstance(one, yaml.MappingNode):
                        merged.update(self._mapping(one, depth + 1))
            else:
                name = self.value(key, depth + 1)
                own[name if isinstance(name, str | int | float | None) else str(name)] = (
                    inner,
                    key.start_mark.line + 1,
                )
        return {**merged, **own}


def _angle(text: str, tag: str) -> float:
    """Return an angle in radians."""
    inner = re.sub(r"^(?:deg|rad)\((.*)\)$", r"\1", text.strip())
    if tag.startswith("!deg"):
        return float(inner) * math.pi / 180.0
    try:
        value = evaluate_text(inner, Dialect())
    except (ExpressionError, UnsupportedError) as error:
        raise ValueError(f"{text} is not an angle ({error})") from None
    if not isinstance(value, int | float):
        raise ValueError(f"{text} is not an angle")  # noqa: TRY004 - all that is wrong with a value is told alike
    return float(value)
