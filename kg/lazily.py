"""Import names when they are first used, as `lazy from` of Python 3.15 does (PEP 810).

    with lazily():
        from kg.pipeline import inferring
        from kg.rules.checks.run import check

A command loads what its run needs and nothing else, although its imports are where readers expect them. Names stand for
modules, functions and classes: they can be called, asked for attributes, used in `isinstance` and derived from.
Constants, and exceptions that are caught, are imported as usual.
"""

from __future__ import annotations

import builtins
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib import import_module
from threading import RLock
from typing import Any, Final

_LOCK: Final = RLock()
_IMPORT: Final = builtins.__import__


@contextmanager
def lazily() -> Iterator[None]:
    """Postpone the imports of a `with` statement at the top of a module; those of other modules are unaffected."""
    here = sys._getframe(2).f_globals  # noqa: SLF001 - the module with the statement

    def postponed(
        name: str,
        globals: Mapping[str, object] | None = None,  # noqa: A002 - as in `__import__`
        locals: Mapping[str, object] | None = None,  # noqa: A002 - the same
        fromlist: Sequence[str] | None = (),
        level: int = 0,
    ) -> Any:
        if globals is not here:
            return _IMPORT(name, globals, locals, fromlist or (), level)
        return _Source(name) if fromlist else Lazy(name)

    with _LOCK:
        outer, builtins.__import__ = builtins.__import__, postponed
        try:
            yield
        finally:
            builtins.__import__ = outer


class _Source:
    """A module that names are imported from."""

    __slots__ = ("_module",)  # with few attributes of its own: each would hide a name of the module

    def __init__(self, module: str) -> None:
        self._module = module

    def __getattr__(self, name: str) -> Lazy:
        """Return a name of the module, without importing it."""
        return Lazy(self._module, name)


class Lazy:
    """A module, or a function, class or submodule of it, that is imported when it is used.

    It is looked up at each use, so what replaces it in its module is used from then on, as by an import in a function.
    """

    __slots__ = ("_module", "_name")

    def __init__(self, module: str, name: str = "") -> None:
        self._module = module
        self._name = name

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Call the function or class."""
        return loaded(self)(*arguments, **named)

    def __getattr__(self, name: str) -> Any:
        """Return an attribute."""
        return getattr(loaded(self), name)

    def __instancecheck__(self, instance: object) -> bool:
        """Check whether something is an object of the class."""
        return isinstance(instance, loaded(self))

    def __mro_entries__(self, bases: tuple[object, ...]) -> tuple[type]:
        """Return the class, to derive from."""
        return (loaded(self),)

    def __repr__(self) -> str:
        """Return the name, without importing it."""
        return f"<lazy {self._module}{'.' + self._name if self._name else ''}>"


def loaded(lazy: Lazy) -> Any:
    """Return what a lazy name stands for, after importing it if necessary."""
    module, name = lazy._module, lazy._name  # noqa: SLF001 - not found by `__getattr__`, which would import
    imported = sys.modules.get(module) or import_module(module)
    if not name:
        return imported
    try:
        return getattr(imported, name)
    except AttributeError:
        return import_module(f"{module}.{name}")
