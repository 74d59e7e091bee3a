"""Numbers as option values."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.cli.options import factor, frequency, seconds, size, whole
from kg.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Callable


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1", 1),
        ("800", 800),
        ("500K", 500 * 1024),
        ("500k", 500 * 1024),
        ("4M", 4 * 1024**2),
        ("1.5G", 3 * 1024**3 // 2),
    ],
)
def test_sizes_are_bytes_or_have_a_unit(text: str, expected: int) -> None:
    """K, M and G, in either case, are powers of 1,024."""
    assert size(text, "--max-memory") == expected


@pytest.mark.parametrize("text", ["", "0", "0K", "K", "-1", "1T", "G1", "²"])
def test_what_is_no_size_is_refused(text: str) -> None:
    """An invalid size is rejected with the option, the text and the syntax."""
    with pytest.raises(UsageError, match=f"`--max-memory {text}` is not a size") as caught:
        size(text, "--max-memory")
    assert (caught.value.code, caught.value.hint) == ("KG003", "Write bytes, or 500K, 4M, 1G.")


@pytest.mark.parametrize("read", [seconds, frequency, factor])
@pytest.mark.parametrize("text", ["0", "-1", "nan", "inf", "1e999", "soon", ""])
def test_what_is_no_number_above_zero_is_refused(read: Callable[[str, str], float], text: str) -> None:
    """Durations, rates and factors are finite and above zero."""
    with pytest.raises(UsageError, match=f"`--for {text}` is not a "):
        read(text, "--for")
    assert read("0.5", "--for") == 0.5


def test_no_timer_is_finer_than_a_millisecond() -> None:
    """A duration is at least a millisecond; rates and factors may be arbitrarily small."""
    assert seconds("0.001", "--for") == 0.001
    with pytest.raises(UsageError):
        seconds("0.0009", "--for")
    assert frequency("0.0009", "--rate") == factor("0.0009", "--speed") == 0.0009


def test_whole_numbers_have_bounds() -> None:
    """Both bounds are allowed, and the error names them."""
    assert [whole(text, "--limit", 1, 3) for text in ("1", "3")] == [1, 3]
    assert whole("99999", "--limit", 0) == 99999
    for text in ("0", "4", "1.5", "x"):
        with pytest.raises(UsageError, match=f"`--limit {text}` is not a whole number from 1 to 3"):
            whole(text, "--limit", 1, 3)
    with pytest.raises(UsageError, match="is not a whole number at least 0"):
        whole("-1", "--limit", 0)
