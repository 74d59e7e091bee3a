"""Random programs, for properties of every tree."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

from kg.robot.programs import tree

__all__ = ["expressions", "programs"]

_WORDS = st.sampled_from(
    ["x", "speed", "to", "end", "my speed", "do", "it's", 'a "b"', "für", "end of it", "count", ""]
)
_TEXTS = st.text(st.characters(exclude_categories=("Cs", "Cc")), max_size=8)
_COMMENTS = st.sampled_from(["", "", "", "slowly", "two\nlines", "  indented", "a\n\nb"])
_IDS = st.none() | st.text(st.sampled_from("ab!#$%()*+,-./:;=?@[]^_`{|}~\"'"), min_size=1, max_size=6)
_CAPABILITIES = st.sampled_from(
    ["drivingAtVelocity", "go to a pose", "stop in an emergency", "end it", "look for", "a b"]
)
_NUMBERS = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-9, 9).map(float)
_LEAVES: Any = st.one_of(
    st.builds(tree.Written, value=_NUMBERS, unit=st.sampled_from([None, "m", "m/s", "%", "deg", "s"])),
    st.builds(tree.Written, value=_TEXTS | st.booleans()),
    st.builds(tree.Variable, name=_WORDS),
    st.builds(tree.Read, capability=_CAPABILITIES, parameter=_WORDS),
)


def _larger(parts: Any) -> Any:
    return st.one_of(
        st.builds(tree.Unary, operator=st.sampled_from(["not", "-", "absolute", "round", "count"]), of=parts),
        st.builds(
            tree.Binary,
            operator=st.sampled_from(["+", "-", "*", "/", "<", "<=", "=", "!=", ">=", ">", "and", "or", "contains"]),
            left=parts,
            right=parts,
        ),
        st.builds(tree.Position, x=parts, y=parts, z=st.none() | parts, heading=st.none() | parts),
    )


expressions: Any = st.recursive(_LEAVES, _larger, max_leaves=6)
_SMALL: Any = st.recursive(_LEAVES, _larger, max_leaves=3)
_MAYBE = st.none() | _SMALL
_HEAD: Any = {"id": _IDS, "comment": _COMMENTS}
_SIMPLE: Any = st.one_of(
    st.builds(
        tree.Do,
        **_HEAD,
        capability=_CAPABILITIES,
        arguments=st.dictionaries(_WORDS, _SMALL, max_size=2),
        seconds=_MAYBE,
        within=_MAYBE,
    ),
    st.builds(tree.Break, **_HEAD),
    st.builds(tree.Stop, **_HEAD),
    st.builds(tree.Set, **_HEAD, variable=_WORDS, value=_SMALL),
    st.builds(tree.Log, **_HEAD, message=_SMALL),
    st.builds(tree.Wait, **_HEAD, seconds=_SMALL),
    st.builds(tree.WaitUntil, **_HEAD, condition=_SMALL, seconds=_MAYBE),
)


def _blocks(statements: Any) -> Any:
    body = st.lists(statements, max_size=3).map(tuple)
    branches = st.lists(body, max_size=3).map(tuple).filter(lambda made: made != ((),))
    return st.one_of(
        st.builds(tree.If, **_HEAD, condition=_SMALL, then=body, otherwise=body),
        st.builds(tree.While, **_HEAD, condition=_SMALL, body=body),
        st.builds(tree.Forever, **_HEAD, body=body),
        st.builds(tree.Repeat, **_HEAD, times=_SMALL, body=body),
        st.builds(tree.For, **_HEAD, variable=_WORDS, start=_SMALL, end=_SMALL, step=_MAYBE, body=body),
        st.builds(tree.For, **_HEAD, variable=_WORDS, of=_SMALL, body=body),
        st.builds(tree.WaitUntil, **_HEAD, condition=_SMALL, seconds=_MAYBE, otherwise=body),
        st.builds(tree.Parallel, **_HEAD, branches=branches),
        st.builds(tree.OnEvent, **_HEAD, condition=_SMALL, then=body, body=body, end=st.booleans()),
    )


_STATEMENTS: Any = st.recursive(_SIMPLE, _blocks, max_leaves=6)
programs: Any = st.builds(
    tree.Program,
    name=_TEXTS,
    comment=_COMMENTS,
    seconds=st.none() | st.floats(0, 1e6),
    body=st.lists(_STATEMENTS, max_size=3).map(tuple),
)
