"""A parameter server: values in a tree of namespaces (wiki.ros.org/ROS/Parameter%20Server%20API)."""

from __future__ import annotations

from typing import Any

__all__ = ["Parameters"]


class Parameters:
    """The parameters of a system; a namespace is the dict of what is in it. A KeyError says that there is none."""

    def __init__(self) -> None:
        self._tree: dict[str, Any] = {}

    def get(self, name: str) -> Any:
        """Return a value, or all of a namespace."""
        found: Any = self._tree
        for part in _parts(name):
            if not isinstance(found, dict):
                raise KeyError(name)
            found = found[part]
        return found

    def set(self, name: str, value: Any) -> None:
        """Set a value, or all of a namespace."""
        *spaces, last = _parts(name) or [""]
        if not last:
            self._tree = value if isinstance(value, dict) else {}
            return
        within = self._tree
        for part in spaces:
            inner = within.get(part)
            within[part] = inner if isinstance(inner, dict) else {}
            within = within[part]
        within[last] = value

    def delete(self, name: str) -> None:
        """Forget a value or namespace."""
        *spaces, last = _parts(name) or [""]
        within = self.get("/".join(spaces))
        if not isinstance(within, dict):
            raise KeyError(name)
        del within[last]

    def search(self, space: str, name: str) -> str:
        """Return the name under which a parameter is found from a namespace upwards."""
        first = name.strip("/").partition("/")[0]
        parts = _parts(space)
        while True:
            inner = "/".join(["", *parts, first])
            try:
                self.get(inner)
            except KeyError:
                if not parts:
                    raise
                parts.pop()
            else:
                return "/".join(["", *parts, name.strip("/")])

    def names(self) -> list[str]:
        """Return the names of all values."""
        found: list[str] = []
        rest: list[tuple[str, Any]] = [("", self._tree)]
        while rest:
            name, value = rest.pop()
            if isinstance(value, dict):
                rest += [(f"{name}/{part}", inner) for part, inner in value.items()]
            else:
                found.append(name)
        return found


def _parts(name: str) -> list[str]:
    return [part for part in name.split("/") if part]
