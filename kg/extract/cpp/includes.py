"""The `#include` lines of a file."""

from __future__ import annotations

__all__ = ["included"]


def included(source: bytes) -> list[str]:
    """Return the paths of the `#include` lines of a file, in order."""
    found = []
    position = source.find(b"#")
    while position >= 0:
        end = source.find(b"\n", position)
        line = source[position + 1 : end if end >= 0 else len(source)].strip()
        if line.startswith(b"include"):
            path = line.removeprefix(b"include").strip()
            closing = path.find(b">" if path.startswith(b"<") else b'"', 1)
            if path[:1] in (b"<", b'"') and closing > 0:
                found.append(path[1:closing].decode("utf-8", "replace"))
        position = source.find(b"#", max(end, position + 1)) if end >= 0 else -1
    return found
