"""Any file is read in bounded time, and gives actions and problems."""

from __future__ import annotations

import random
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from files.ros2.python.described import described, read_text
from hypothesis import given, settings
from hypothesis import strategies as st

SEEDS = [path.read_bytes() for path in sorted((Path(__file__).parent / "cases").glob("*/launch.py"))]
WRAPPED = (
    "from launch import LaunchDescription\ndef generate_launch_description():\n    return LaunchDescription([{}])\n"
)


def read(text: bytes) -> str:
    """Return the result of reading a text as a launch file."""
    with TemporaryDirectory() as folder:
        return described(*read_text(Path(folder), {"launch.py": text}))


def mutated(text: bytes, seed: int) -> bytes:
    """Return a text with lines and words moved or removed."""
    source = random.Random(seed)  # noqa: S311 - nothing secret
    words = text.replace(b"(", b" ( ").replace(b")", b" ) ").replace(b",", b" , ").split(b" ")
    for _ in range(source.randint(1, 4)):
        here, there = source.randrange(len(words)), source.randrange(len(words))
        kind = source.randrange(3)
        if kind == 0:
            words[here] = words[there]
        elif kind == 1:
            words[here], words[there] = words[there], words[here]
        else:
            words[here] = source.choice([b"None", b"0", b"[]", b"{}", b"''", b"context", b"lambda: x", b"1.5"])
    return b" ".join(words)


@settings(max_examples=100, deadline=None)
@given(st.sampled_from(SEEDS), st.integers(0, 2**32))
def test_mutations(text: bytes, seed: int) -> None:
    """A file with moved words is read, or is malformed."""
    read(mutated(text, seed))


@settings(max_examples=40, deadline=None)
@given(st.binary(max_size=200))
def test_bytes(text: bytes) -> None:
    """Any bytes are read, or are malformed."""
    read(text)


@pytest.mark.parametrize(
    "expression",
    [
        "(" * 5_000,
        "-" * 50_000 + "1",
        "1" + "+1" * 20_000,
        "x" + ".a" * 20_000,
        "'a' * 10**12",
        "'%1000000000d' % 1",
        "f'{1:1000000000}'",
        "'{:>1000000000}'.format(1)",
        "[[[0] * 20000 for a in range(20000)] for b in range(20000)]",
        "(lambda f: f(f))(lambda f: f(f))",
        "[x for x in range(10**30)]",
        "'x'.zfill(10**9)",
        "('ab' * 9000).replace('', 'x' * 9000)",
        "int('9' * 5000)",
        "9 ** 9 ** 9 ** 9",
        "1 << 10**10",
    ],
    ids=lambda expression: expression[:20],
)
def test_hostile_expressions(expression: str) -> None:
    """An expression that would exhaust memory, time or stack is unknown."""
    assert read(WRAPPED.format(expression).encode())


def test_doubling() -> None:
    """A text or list that is doubled repeatedly ends at a limit."""
    body = "    a, b = 'x', [1]\n    for i in range(1000):\n        a += a\n        b += b\n    return a\n"
    assert "limit" in read(f"def generate_launch_description():\n{body}".encode())


def test_aliases_of_yaml(tmp_path: Path) -> None:
    """A YAML file with unbounded aliases is read within the limits."""
    layers = "".join(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]\n" for n in range(1, 30))
    text = "import yaml\ndef generate_launch_description():\n    return yaml.safe_load(open(FILE))\n".replace(
        "FILE", "__file__[:-9] + 'x.yaml'"
    )
    files = {"launch.py": text, "x.yaml": f"a0: &a0 [1]\n{layers}"}
    assert "limit" in described(*read_text(tmp_path, files))
