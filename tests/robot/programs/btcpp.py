"""The rules of BehaviorTree.CPP 4 for its XML, and random valid programs that have behaviour trees."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final

from hypothesis import strategies as st

from kg.robot.programs import tree

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml.etree import _Element

__all__ = ["programs", "violations"]

# For each standard node written by kg: its ports, the required ones, and the least and most children.
NODES: Final[dict[str, tuple[set[str], set[str], int, int]]] = {
    "AlwaysFailure": (set(), set(), 0, 0),
    "AlwaysSuccess": (set(), set(), 0, 0),
    "Delay": ({"delay_msec"}, {"delay_msec"}, 1, 1),
    "Fallback": (set(), set(), 1, 999),
    "IfThenElse": (set(), set(), 2, 3),
    "KeepRunningUntilFailure": (set(), set(), 1, 1),
    "LoopDouble": ({"queue", "value", "if_empty"}, {"queue", "value"}, 1, 1),
    "Parallel": ({"success_count", "failure_count"}, set(), 1, 999),
    "ReactiveFallback": (set(), set(), 1, 999),
    "Repeat": ({"num_cycles"}, {"num_cycles"}, 1, 1),
    "RetryUntilSuccessful": ({"num_attempts"}, {"num_attempts"}, 1, 1),
    "Script": ({"code"}, {"code"}, 0, 0),
    "ScriptCondition": ({"code"}, {"code"}, 0, 0),
    "Sequence": (set(), set(), 1, 999),
    "Sleep": ({"msec"}, {"msec"}, 0, 0),
    "SubTree": (set(), {"ID"}, 0, 0),
    "Timeout": ({"msec"}, {"msec"}, 1, 1),
}
_NAME: Final = re.compile(r"[^ \t\n\r<>&\"'/\\:*?|.\d][^ \t\n\r<>&\"'/\\:*?|.]*")
_TREE: Final = re.compile(r"(?!(?i:root)$)[^ \t\n\r<>&\"'/\\:*?|.]+")
_RESERVED: Final = {"name", "ID", "_autoremap"}
_PORTS: Final = {"input_port", "output_port", "inout_port"}
_CONDITIONS: Final = {"_skipIf", "_successIf", "_failureIf", "_while", "_onSuccess", "_onFailure", "_onHalted"}


def violations(root: _Element) -> Iterator[str]:
    """Yield the parts of a file that BehaviorTree.CPP 4 would reject or misinterpret."""
    if root.tag != "root" or root.get("BTCPP_format") != "4":
        yield "no root of version 4"
    models = root.findall("TreeNodesModel")
    if len(models) != 1:
        yield f"{len(models)} models"
    trees = root.findall("BehaviorTree")
    if root.get("main_tree_to_execute") not in {one.get("ID") for one in trees}:
        yield "no main tree"
    known = dict(NODES)
    for model in models[0] if models else ():
        yield from _of_model(model)
        given = {str(one.get("name")) for one in model}
        known[str(model.get("ID"))] = (given, set(), 0, 0)
    for one in trees:
        if one.get("ID") in known or not _TREE.fullmatch(str(one.get("ID"))):
            yield f"the tree {one.get('ID')}"
        if len(one) != 1:
            yield "a tree has one child"
        for node in one.iterdescendants():
            yield from _of_node(node, known)


def _of_model(model: _Element) -> Iterator[str]:
    if model.tag not in {"Action", "Condition", "Control", "Decorator", "SubTree"} or not model.get("ID"):
        yield f"the model {model.tag}"
    names = [str(one.get("name")) for one in model]
    for one, name in zip(model, names, strict=True):
        if one.tag not in _PORTS or not _NAME.fullmatch(name) or name in _RESERVED:
            yield f"the port {name} of {model.get('ID')}"
    if len(names) != len(set(names)):
        yield f"a port of {model.get('ID')} twice"


def _of_node(node: _Element, known: dict[str, tuple[set[str], set[str], int, int]]) -> Iterator[str]:
    if node.tag not in known:
        yield f"the node {node.tag} is not described"
        return
    ports, needed, least, most = known[str(node.tag)]
    given = {str(one) for one in node.attrib} - {"name"}
    plain = {one for one in given if not one.startswith("_")}
    if plain - ports or needed - plain:
        yield f"{node.tag} has the ports {sorted(plain)}"
    if given & _CONDITIONS:
        yield f"{node.tag} has a condition"
    if not least <= len(node) <= most:
        yield f"{node.tag} has {len(node)} children"


def _value(value: Any, unit: str | None = None) -> tree.Written:
    return tree.Written(value=value, unit=unit)


def _seconds() -> Any:
    return st.one_of(st.integers(1, 90000).map(lambda one: _value(float(one), "ms")), st.just(_value(2.5, "s")))


_NUMBERS: Any = st.floats(-1, 1, allow_subnormal=False).map(lambda one: round(one, 4))
_LENGTHS: Any = st.one_of(
    _NUMBERS.map(lambda one: _value(one, "m")),
    st.integers(-99, 99).map(lambda one: _value(float(one), "cm")),
    st.sampled_from([tree.Read(capability="scan with a laser", parameter="nearest"), tree.Variable(name="far")]),
    st.just(tree.Read(capability="sensingPose", parameter="x")),
)
_MANY: Any = st.builds(
    tree.Binary,
    operator=st.sampled_from([">", "="]),
    left=st.just(tree.Unary(operator="count", of=tree.Read(capability="sense contact", parameter="places"))),
    right=st.integers(0, 3).map(lambda one: _value(float(one))),
)
_SUMS: Any = st.recursive(
    _LENGTHS, lambda one: st.builds(tree.Binary, operator=st.sampled_from("+-"), left=one, right=one), max_leaves=3
)
_TRUTHS: Any = st.recursive(
    st.one_of(
        st.builds(tree.Binary, operator=st.sampled_from(["<", "<=", ">", ">=", "=", "!="]), left=_SUMS, right=_SUMS),
        st.just(tree.Read(capability="sensingContact", parameter="pressed")),
        _MANY,
        st.just(tree.Variable(name="my flag")),
        st.booleans().map(_value),
    ),
    lambda one: st.one_of(
        st.builds(tree.Unary, operator=st.just("not"), of=one),
        st.builds(tree.Binary, operator=st.sampled_from(["and", "or"]), left=one, right=one),
    ),
    max_leaves=3,
)
_TEXTS: Any = st.text(st.characters(codec="utf-8", exclude_categories=("Cs", "Cc", "Zl", "Zp")), max_size=8).filter(
    lambda one: not (one.startswith("{") and one.endswith("}"))
)
_COMMENTS: Any = st.sampled_from(["", "", "slowly", "two\nlines"])
_SPEEDS: Any = st.floats(-0.9, 0.9).map(lambda one: _value(round(one, 3), "m/s"))
_PLACES: Any = st.builds(
    tree.Position,
    x=_NUMBERS.map(lambda one: _value(one, "m")),
    y=_NUMBERS.map(_value),
    heading=st.none() | st.integers(-90, 90).map(lambda one: _value(float(one), "deg")),
)
_SIMPLE: Any = st.one_of(
    st.builds(
        tree.Do,
        comment=_COMMENTS,
        capability=st.sampled_from(["move at a velocity", "drivingAtVelocity"]),
        arguments=st.fixed_dictionaries({}, optional={"forward": _SPEEDS, "turn": st.just(_value(20.0, "deg/s"))}),
        seconds=_seconds(),
    ),
    st.builds(
        tree.Do,
        capability=st.just("go to a pose"),
        arguments=st.fixed_dictionaries({"x": _SUMS}, optional={"heading": st.just(_value(45.0, "deg"))}),
        within=st.none() | _seconds(),
    ),
    st.builds(
        tree.Do,
        capability=st.just("go to a pose"),
        arguments=st.fixed_dictionaries({"at": _PLACES | st.just(tree.Variable(name="kitchen"))}),
    ),
    st.just(tree.Do(capability="saying", arguments={"words": _value("hello")})),
    st.just(tree.Stop(comment="enough")),
    st.builds(tree.Set, variable=st.just("far"), value=_SUMS, comment=_COMMENTS),
    st.builds(tree.Set, variable=st.just("my flag"), value=_TRUTHS),
    st.builds(tree.Set, variable=st.just("kitchen"), value=_PLACES),
    st.builds(tree.Log, message=_TEXTS.map(_value) | _SUMS),
    st.builds(tree.Log, message=st.builds(tree.Binary, operator=st.just("+"), left=_TEXTS.map(_value), right=_LENGTHS)),
    st.builds(tree.Wait, seconds=_seconds()),
    st.builds(tree.WaitUntil, condition=_TRUTHS, seconds=st.none() | _seconds()),
)


def _blocks(statements: Any) -> Any:
    body = st.lists(statements, max_size=3).map(tuple)
    turn = st.tuples(body, st.just(tree.Wait(seconds=_value(0.1, "s")))).map(lambda both: (*both[0], both[1]))
    left = turn.map(lambda one: (*one, tree.If(condition=tree.Variable(name="my flag"), then=(tree.Break(),))))
    turn = turn | left
    return st.one_of(
        st.builds(tree.If, condition=_TRUTHS, then=body, otherwise=body, comment=_COMMENTS),
        st.builds(tree.While, condition=_TRUTHS, body=turn),
        st.builds(tree.Forever, body=turn),
        st.builds(tree.Repeat, times=st.integers(1, 9).map(lambda one: _value(float(one))), body=turn),
        st.builds(
            tree.For,
            variable=st.just("i"),
            start=st.integers(-9, 9).map(lambda one: _value(float(one))),
            end=st.integers(-9, 9).map(lambda one: _value(float(one))),
            step=st.none() | st.sampled_from([_value(3.0), _value(0.5), _value(0.1)]),
            body=turn,
        ),
        st.builds(tree.WaitUntil, condition=_TRUTHS, seconds=_seconds(), otherwise=body),
        st.builds(tree.Parallel, branches=st.tuples(st.just((tree.Wait(seconds=_value(1.0, "s")),)), body)),
        st.builds(tree.OnEvent, condition=_TRUTHS, then=body, body=body, end=st.just(True)),
    )


_GIVEN: Final = (
    tree.Set(variable="far", value=_value(2.0, "m")),
    tree.Set(variable="my flag", value=_value(False)),
    tree.Set(variable="kitchen", value=tree.Position(x=_value(1.0, "m"), y=_value(2.0, "m"))),
)
programs: Any = st.builds(
    tree.Program,
    name=_TEXTS.filter(bool),
    comment=_COMMENTS,
    seconds=st.none() | st.integers(1, 900).map(float),
    body=st.lists(st.recursive(_SIMPLE, _blocks, max_leaves=5), max_size=3).map(lambda body: (*_GIVEN, *body)),
)
