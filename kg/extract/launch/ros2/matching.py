"""Names of nodes in parameter files, matched with the name of a node.

Source: `rclcpp::parameter_map_from`, where `/*` stands for one part of a name and `/**` for any number of them.
"""

from __future__ import annotations

import re
from functools import lru_cache

from kg.extract.launch.ros2.context import HOLE

__all__ = ["fits"]


def fits(key: str, namespace: str, name: str | None) -> bool | None:
    """Tell whether a key of a parameter file is for a node; None where that depends on what is not known.

    A node whose own `name` is kept is fitted by wildcards alone: launch does not know what it is called.
    """
    absolute = "/" + key.strip("/")
    if name is None:
        pattern = _pattern(absolute)
        return bool(pattern.fullmatch(f"{namespace.rstrip('/')}/\N{MIDDLE DOT}")) if _ends_wild(absolute) else False
    full = f"{namespace.rstrip('/')}/{name}"
    if HOLE not in full:
        return full == absolute or ("*" in absolute and bool(_pattern(absolute).fullmatch(full)))
    if absolute == "/**":
        return True
    possible = re.compile(".*".join(re.escape(part) for part in full.split(HOLE)), re.DOTALL)
    return None if "*" in absolute or possible.fullmatch(absolute) else False


def _ends_wild(key: str) -> bool:
    return key.endswith("*")


@lru_cache(maxsize=1024)
def _pattern(key: str) -> re.Pattern[str]:
    r"""Return the expression that a key with wildcards means; a part of a name is `\w+`, or one that is not known."""
    parts = []
    for piece in re.split(r"(/\*\*|/\*)", key):
        match piece:
            case "/**":
                parts.append("(?:/[\\w\N{MIDDLE DOT}]+)*")
            case "/*":
                parts.append("(?:/[\\w\N{MIDDLE DOT}]+)")
            case _:
                parts.append(re.escape(piece))
    return re.compile("".join(parts))
