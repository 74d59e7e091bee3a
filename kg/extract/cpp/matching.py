"""Which entry of the tables a call or construction is a use of, by receiver, scope and number of arguments."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.extract.cpp.context import EMPTY
from kg.extract.cpp.sites import fits

if TYPE_CHECKING:
    from kg.extract.cpp.api import CallSpec, ParameterSpec, TypeSpec
    from kg.extract.cpp.context import Site
    from kg.extract.cpp.evaluate import Evaluator
    from kg.extract.cpp.syntax import Callee
    from kg.extract.cpp.types import TypeName
    from kg.extract.cpp.unit import Expr

__all__ = ["Matcher"]


class Matcher:
    """Matches uses against the tables."""

    def __init__(self, evaluator: Evaluator) -> None:
        self._evaluator = evaluator
        self._program = evaluator.program

    def call(self, specs: tuple[CallSpec, ...], where: Expr, called: Callee, given: list[Expr]) -> CallSpec | None:
        """Return the entry that a call is a use of."""
        fitting = [spec for spec in specs if _fits(spec, called, given)]
        if not fitting:
            return None
        if called.scope:
            return next((spec for spec in fitting if called.scope[-1] in spec.scopes), None)
        if called.receiver is None:
            return self._unqualified(fitting, where, called, given)
        kind = self._evaluator.types.of(where.child(called.receiver), EMPTY)
        return self._method(fitting, kind, called, given)

    def _unqualified(self, specs: list[CallSpec], where: Expr, called: Callee, given: list[Expr]) -> CallSpec | None:
        if self._defined(called, where, given):
            return None
        cls = self._evaluator.types.class_around(where.unit, where.at)
        for spec in specs:
            if spec.specified:
                continue
            if spec.inherited and cls is not None:
                return spec
            if spec.receivers and spec.ros == 2 and cls is not None:  # noqa: PLR2004 - in ROS 2 a class is its node
                return spec
        return next((spec for spec in specs if spec.scopes and _used(where, spec)), None)

    def _defined(self, called: Callee, where: Expr, given: list[Expr]) -> bool:
        """Tell whether an unqualified call means a function of the program."""
        around = self._evaluator.types.class_around(where.unit, where.at)
        family = list(self._program.family(around)) if around is not None else []
        for function in self._program.functions(called.name):
            owner = self._program.owner(function)
            if fits(function, len(given)) and (owner in family if owner is not None else True):
                return True
        return False

    def _method(
        self, specs: list[CallSpec], kind: TypeName | None, called: Callee, given: list[Expr]
    ) -> CallSpec | None:
        methods = [spec for spec in specs if spec.receivers and (not spec.specified or _named(kind, spec))]
        if kind is None:
            return next((spec for spec in methods if not spec.exact), None)
        name = kind.name.removesuffix("ConstPtr").removesuffix("Ptr")
        exact = next((spec for spec in methods if name in spec.receivers), None)
        if exact is not None:
            return exact
        cls = self._evaluator.types.class_of(kind)
        if cls is None:
            return self._foreign(methods, kind)
        family = list(self._program.family(cls))
        for function in self._program.functions(called.name):
            if self._program.owner(function) in family and fits(function, len(given)):
                return None
        if self._evaluator.api.is_node(self._evaluator, cls) or not self._program.bases(family[-1])[1]:
            return next((spec for spec in methods if spec.ros == 2), None)  # noqa: PLR2004 - in ROS 2 a class is its node
        return None

    def _foreign(self, specs: list[CallSpec], kind: TypeName) -> CallSpec | None:
        """Return the entry for a receiver whose type is not in the build: one of ROS 2's, whose names are its own."""
        if kind.name.endswith(("Node", "NodeT", "NodeHandle", "NodePtr")) or len(kind.name) == 1:
            return next((spec for spec in specs if not spec.exact), None)
        return None

    def parameter(
        self, specs: tuple[ParameterSpec, ...], where: Expr, called: Callee, given: list[Expr]
    ) -> ParameterSpec | None:
        """Return the entry that a call which handles a parameter is a use of."""
        fitting = [spec for spec in specs if spec.least <= len(given) <= spec.most]
        if called.receiver is None and (helper := next((spec for spec in fitting if spec.helper), None)):
            return helper
        if called.scope and called.receiver is None:
            return next((spec for spec in fitting if called.scope[-1] in spec.scopes), None)
        methods = [spec for spec in fitting if not spec.scopes and not spec.helper]
        if not methods:
            return None
        if called.receiver is None:
            own = methods[0].ros == 2 and not self._defined(called, where, given)  # noqa: PLR2004 - in ROS 2 a class is its node
            return methods[0] if own else None
        kind = self._evaluator.types.of(where.child(called.receiver), EMPTY)
        if kind is None or kind.name.removesuffix("Ptr") in methods[0].receivers:
            return methods[0]
        cls = self._evaluator.types.class_of(kind)
        if cls is None:
            known = kind.name.endswith(("Node", "NodeT", "NodeHandle", "NodePtr")) or len(kind.name) == 1
            return methods[0] if known else None
        family = list(self._program.family(cls))
        if any(self._program.owner(function) in family for function in self._program.functions(called.name)):
            return None
        return (
            methods[0]
            if self._evaluator.api.is_node(self._evaluator, cls) or not self._program.bases(family[-1])[1]
            else None
        )

    def type(self, site: Site) -> tuple[TypeSpec, tuple[Expr, ...]] | None:
        """Return the entry that a construction is a use of, and the template arguments of the type."""
        settled = self._evaluator.types.constructed(site)
        for kind in settled:
            for spec in self._evaluator.api.types.get(kind.name, ()):
                if not spec.scopes or (len(kind.parts) > 1 and kind.parts[-2] in spec.scopes):
                    return spec, kind.arguments or site.template
                if len(kind.parts) == 1 and any(scope in spec.scopes for scope in kind.where.unit.used_namespaces):
                    return spec, kind.arguments or site.template
        return None


def _named(kind: TypeName | None, spec: CallSpec) -> bool:
    return kind is not None and kind.name in spec.receivers


def _fits(spec: CallSpec, called: Callee, given: list[Expr]) -> bool:
    """Tell whether a call has the arguments that an entry needs."""
    if not spec.least <= len(given) <= spec.most or (spec.explicit and called.template is None):
        return False
    return spec.specified or max(spec.name, spec.handle or 0) < len(given)


def _used(where: Expr, spec: CallSpec) -> bool:
    used = {name.rpartition("::")[2] for name in where.unit.used_namespaces}
    return bool(used & spec.scopes)
