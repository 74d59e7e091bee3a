"""Paths: `os.path` and `pathlib` over the texts by which files of the build are named (`package://NAME/path`)."""

from __future__ import annotations

import posixpath
from typing import TYPE_CHECKING, Final

from kg.extract.launch.expressions.texts import join, simplify, to_text
from kg.extract.launch.expressions.values import Substitution, Words

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.extract.launch.expressions.values import Part, Text, Value

__all__ = ["base", "join_paths", "normal", "parent", "split"]

_MARK: Final = "://"


def join_paths(values: Sequence[Value]) -> str | Words:
    """Return `os.path.join` of texts that may have unknown parts; one that is absolute begins anew."""
    parts: list[Part] = []
    for value in values:
        text = to_text(value)
        if text and isinstance(text[0], str) and (text[0].startswith("/") or _MARK in text[0]):
            parts = list(text)
        elif parts and not (isinstance(parts[-1], str) and parts[-1].endswith("/")):
            parts += ["/", *text]
        else:
            parts += text
    return simplify(_below_prefix(join(parts)))


def _below_prefix(parts: Text) -> Text:
    """Return `PREFIX/share/NAME/...` as the folder of the package NAME that it is."""
    if len(parts) < 2 or not isinstance(parts[0], Substitution) or parts[0].kind != "find-pkg-prefix":  # noqa: PLR2004 - prefix and rest
        return parts
    name, rest = parts[0].arguments[0], parts[1]
    if len(name) != 1 or not isinstance(name[0], str) or not isinstance(rest, str):
        return parts
    share = f"/share/{name[0]}"
    if rest != share and not rest.startswith(f"{share}/"):
        return parts
    return (f"package://{name[0]}{rest[len(share) :]}", *parts[2:])


def split(text: str) -> tuple[str, str]:
    """Return the head that names a package or source (empty for other paths) and the path below it."""
    scheme, mark, rest = text.partition(_MARK)
    if not mark:
        return "", text
    head, slash, inner = rest.partition("/")
    return f"{scheme}{mark}{head}", slash + inner


def parent(value: str | Words) -> str | Words:
    """Return `os.path.dirname`; the folder of a package has none that is known."""
    if isinstance(value, Words):
        last = value.parts[-1] if value.parts else ""
        if isinstance(last, str) and "/" in last:
            return simplify((*value.parts[:-1], last.rpartition("/")[0]))
        return Words((Substitution("unknown", reason="the folder of a path that is not known"),))
    head, inner = split(value)
    if head and not inner.strip("/"):
        return Words((Substitution("unknown", reason=f"what is above the folder {head}"),))
    return head + posixpath.dirname(inner).rstrip("/") if head else posixpath.dirname(inner)


def base(value: str | Words) -> str | Words:
    """Return `os.path.basename`."""
    if isinstance(value, str):
        head, inner = split(value)
        return posixpath.basename(inner) or head.rpartition("/")[2]
    last = value.parts[-1] if value.parts else ""
    if isinstance(last, str) and "/" in last:
        return last.rpartition("/")[2]
    return Words((Substitution("unknown", reason="the name of a path that is not known"),))


def normal(value: str | Words) -> str | Words:
    """Return `os.path.normpath`, which leaves a path alone where a part is not known."""
    if isinstance(value, Words):
        return value
    head, inner = split(value)
    if not head:
        return posixpath.normpath(inner) if inner else inner
    path = posixpath.normpath(inner.lstrip("/")) if inner.strip("/") else ""
    if path.startswith(".."):
        return Words((Substitution("unknown", reason=f"what is above the folder {head}"),))
    return f"{head}/{path}" if path not in {"", "."} else head
