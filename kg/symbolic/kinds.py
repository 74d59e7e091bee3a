"""Types that point to others: smart pointers, and the pointer aliases that generated messages have."""

from __future__ import annotations

import re
from typing import Final

from kg.symbolic.values import Kind, TypeValue

POINTER: Final = "*"
"""The name of the type of a plain pointer, with the type that it points to as its argument."""

POINTERS: Final = frozenset(
    {
        POINTER,
        "shared_ptr",
        "unique_ptr",
        "weak_ptr",
        "scoped_ptr",
        "intrusive_ptr",
        "optional",
        "reference_wrapper",
        "atomic",
        "RealtimeBuffer",
        "RealtimeBox",
    }
)
"""Templates whose objects behave like the object that they hold."""
POINTER_ALIASES: Final = frozenset(
    {
        "SharedPtr",
        "ConstSharedPtr",
        "UniquePtr",
        "ConstUniquePtr",
        "WeakPtr",
        "ConstWeakPtr",
        "Ptr",
        "ConstPtr",
        "SharedFuture",
    }
)
"""Types within a class that point to it: `Image::SharedPtr`."""
POINTER_NAME: Final = re.compile(r"(?:Const)?(?:Shared|Unique|Weak)?Ptr$")
"""The end of names that macros, such as `MOVEIT_CLASS_FORWARD`, and generators give to pointers to a class."""
_DEEPEST: Final = 6


def is_pointer(kind: Kind) -> bool:
    """Check whether objects of a type only point to others, or behave like the object that they hold."""
    return kind.cls is None and (kind.name in POINTERS or kind.name in POINTER_ALIASES)


def pointee(kind: Kind) -> Kind:
    """Return the type that a pointer points to; other types are returned as they are."""
    for _ in range(_DEEPEST):
        if kind.cls is None and kind.name in POINTERS and kind.arguments and isinstance(kind.arguments[0], TypeValue):
            kind = kind.arguments[0].kind
        elif kind.cls is None and kind.name in POINTER_ALIASES and len(kind.names) > 1:
            kind = Kind(kind.names[:-1], kind.arguments)
        else:
            return kind
    return kind
