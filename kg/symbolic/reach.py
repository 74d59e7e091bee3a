"""Which functions can lead to a call that a framework defines, by the words of their code.

A function reaches an effect if its code contains the name of a described call or class, or the name of a function that
reaches one. Names are compared without their scopes, so the answer may be yes for a function that has no effect.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Protocol, TypeAlias

from kg.symbolic.descriptions import is_managed

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.symbolic.descriptions import Descriptions
    from kg.symbolic.form import Class, Function

    Code: TypeAlias = Function | Class


GIVES_NODE: Final = "(node)"
"""A word of code that creates an object with a node or a handle, with which its class can do anything."""


class Program(Protocol):
    """Meaning of the words of a program."""

    revision: int
    """Changes when the program gets more code."""

    def words(self, code: Code) -> frozenset[str] | None:
        """Return the words in a function, or in what the creation of an object runs; None if there is no code."""

    def assigned(self, code: Code) -> frozenset[str]:
        """Return the names of variables and fields that the code of a function changes."""

    def definitions(self, words: frozenset[str]) -> Iterable[Code]:
        """Return the functions and classes that some words can name, constructors among them."""

    def is_alias(self, word: str) -> bool:
        """Check whether a word is also declared as another name of something."""

    def mentions(self, word: str) -> bool:
        """Check whether any file of the program contains a word."""


class Reach:
    """The functions of a program that can lead to effects of `descriptions`."""

    def __init__(self, descriptions: Descriptions, program: Program) -> None:
        self._effects = descriptions.effects
        self._program = program
        self._leading: dict[int, bool] = {}
        self._changed: dict[int, frozenset[str]] = {}
        self._revision = 0

    def reaches(self, function: Function) -> bool:
        """Check whether a run of a function can have an effect; its own template parameters can stand for any class.

        Those of the code that it calls are bound on the way: what they stand for is among the words of other code.
        """
        return not _unbound(function).isdisjoint(self._program.words(function) or ()) or self._leads(function)

    def _leads(self, function: Function) -> bool:
        """Check whether the code of a function contains a call with an effect, or leads to one."""
        self._forget()
        cached = self._leading.get(id(function))
        if cached is not None:
            return cached
        seen = {id(function)}
        looked = set[str]()
        pending: list[Code] = [function]
        while pending:
            words = self._program.words(pending.pop())
            if words is None or self._has_effect(words):
                self._leading[id(function)] = True
                return True
            words -= looked
            looked |= words
            for called in self._program.definitions(words):
                key = id(called)
                if self._leading.get(key):
                    self._leading[id(function)] = True
                    return True
                if key not in seen and key not in self._leading:
                    seen.add(key)
                    pending.append(called)
        self._leading.update(dict.fromkeys(seen, False))
        return False

    def changes(self, function: Function) -> frozenset[str]:
        """Return the names of what a run of a function can change."""
        self._forget()
        cached = self._changed.get(id(function))
        if cached is None:
            assigned = map(self._program.assigned, self._closure([function])[0])
            cached = self._changed[id(function)] = frozenset().union(*assigned)
        return cached

    def uses(self, functions: Iterable[Function]) -> set[str]:
        """Return the words in the code that runs of some functions can reach."""
        return self._closure(functions)[1]

    def _closure(self, functions: Iterable[Function]) -> tuple[list[Code], set[str]]:
        """Return the code that runs of some functions can reach, with its words."""
        reachable: list[Code] = [*functions]
        seen = set(map(id, reachable))
        looked = set[str]()
        for code in reachable:
            words = (self._program.words(code) or frozenset()) - looked
            looked |= words
            for called in self._program.definitions(words):
                if id(called) not in seen:
                    seen.add(id(called))
                    reachable.append(called)
        return reachable, looked

    def _forget(self) -> None:
        """Forget what may be otherwise now that the program has more code."""
        if self._program.revision != self._revision:
            self._revision = self._program.revision
            self._leading = {key: leads for key, leads in self._leading.items() if leads}
            self._changed.clear()

    def _has_effect(self, words: frozenset[str]) -> bool:
        if GIVES_NODE in words:
            return True
        for word in words & self._effects.keys():
            for scopes, classes in self._effects[word]:
                if scopes and not any(scope <= words for scope in scopes) and not self._program.is_alias(word):
                    continue
                if not classes or any(map(self._program.mentions, classes)):
                    return True
        return any(map(is_managed, words))


def _unbound(function: Function) -> frozenset[str]:
    """Return the template parameters of a function and of its class."""
    return frozenset(function.template + (function.owner.template if function.owner is not None else ()))
