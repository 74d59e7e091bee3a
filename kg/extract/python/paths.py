"""Paths: `os.path` and `pathlib` over texts. A path of `pathlib` is its text.

The head of a path like `package://NAME/path` names a folder; what is above it is not known.
"""

from __future__ import annotations

import posixpath
from typing import TYPE_CHECKING, Final

from kg.extract.python.texts import stringified
from kg.holes import Hole
from kg.symbolic.values import Sequence, Text, Unknown, Value, as_text, concatenate

if TYPE_CHECKING:
    from collections.abc import Callable

_MARK: Final = "://"
_PARENTS: Final = 8


def joined(values: list[Value]) -> Value:
    """Return `os.path.join`: parts with one slash between them; an absolute part starts again."""
    result = Text.of("")
    for value in values:
        part = as_text(stringified(value))
        first, last = part.parts[0] if part.parts else "", result.parts[-1]
        if isinstance(first, str) and (first.startswith("/") or _MARK in first):
            result = part
            continue
        slash = "" if last == "" or (isinstance(last, str) and last.endswith("/")) else "/"
        result = as_text(concatenate(result, Text.of(slash), part))
    return result


def split(text: str) -> tuple[str, str]:
    """Return the head that names a folder (empty for other paths) and the path below it."""
    scheme, mark, rest = text.partition(_MARK)
    if not mark:
        return "", text
    head, slash, inner = rest.partition("/")
    return f"{scheme}{mark}{head}", slash + inner


def _parent(of: Text) -> Value:
    """Return `os.path.dirname`."""
    if of.exact is None:
        last = of.parts[-1]
        if isinstance(last, Hole) or "/" not in last:
            return Text.hole("the folder of a path that is not known")
        return Text((*of.parts[:-1], last.rpartition("/")[0]), of.resolution, of.parameter, of.reason)
    head, inner = split(of.exact)
    if head and not inner.strip("/"):
        return Text.hole(f"the path above the folder {head}")
    return Text.of(head + posixpath.dirname(inner).rstrip("/") if head else posixpath.dirname(inner))


def _base(of: Text) -> Value:
    """Return `os.path.basename`."""
    last = of.exact if of.exact is not None else of.parts[-1]
    if isinstance(last, Hole) or (of.exact is None and "/" not in last):
        return Text.hole("the name of a path that is not known")
    head, inner = split(last)
    return Text.of(posixpath.basename(inner) or head.rpartition("/")[2])


def _normal(of: Text) -> Value:
    """Return `os.path.normpath`, which leaves a path alone if a part is not known."""
    if of.exact is None:
        return of
    head, inner = split(of.exact)
    if not head:
        return Text.of(posixpath.normpath(inner) if inner else inner)
    path = posixpath.normpath(inner.lstrip("/")) if inner.strip("/") else ""
    if path.startswith(".."):
        return Text.hole(f"the path above the folder {head}")
    return Text.of(f"{head}/{path}" if path not in ("", ".") else head)


def _ends(of: Text) -> Value:
    """Return `os.path.splitext`."""
    if of.exact is None:
        return Unknown(of.reason or "the path is not known")
    return Sequence(tuple(map(Text.of, posixpath.splitext(of.exact))))


def _part(index: int) -> Callable[[Text], Value]:
    """Return the reader of the stem or the suffix of a path."""

    def apply(of: Text) -> Value:
        name = _base(of)
        exact = name.exact if isinstance(name, Text) else None
        return Text.of(posixpath.splitext(exact)[index]) if exact is not None else name

    return apply


def _parents(of: Text) -> Value:
    parents: list[Value] = []
    current: Value = of
    while isinstance(current, Text) and len(parents) < _PARENTS:
        current = _parent(current)
        parents.append(current)
    return Sequence(tuple(parents))


def _renamed(name: str) -> Callable[[Text, list[Value]], Value]:
    def apply(of: Text, given: list[Value]) -> Value:
        new = given[0].exact if given and isinstance(given[0], Text) else None
        if of.exact is None or new is None:
            return Unknown(of.reason or "the path is not known")
        folder, slash, last = of.exact.rpartition("/")
        stem = last.rpartition(".")[0] or last
        return Text.of(folder + slash + (stem + new if name == "with_suffix" else new))

    return apply


FUNCTIONS: Final[dict[str, Callable[[Text], Value]]] = {
    "os.path.dirname": _parent,
    "os.path.basename": _base,
    **dict.fromkeys(("os.path.abspath", "os.path.realpath", "os.path.normpath"), _normal),
    **dict.fromkeys(("os.path.expanduser", "os.fspath"), lambda of: of),
    "os.path.splitext": _ends,
}
"""Functions of one path."""
MEMBERS: Final[dict[str, Callable[[Text], Value]]] = {
    "parent": _parent,
    "parents": _parents,
    "name": _base,
    "stem": _part(0),
    "suffix": _part(1),
}
"""Members of a path of `pathlib`."""
METHODS: Final[dict[str, Callable[[Text, list[Value]], Value]]] = {
    "joinpath": lambda of, given: joined([of, *given]),
    **dict.fromkeys(("as_posix", "__str__"), lambda of, _: of),
    **dict.fromkeys(("resolve", "absolute", "expanduser"), lambda of, _: _normal(of)),
    **{name: _renamed(name) for name in ("with_suffix", "with_name")},
}
"""Methods of a path of `pathlib`."""
