"""The codes of `kg lint` itself, beside those of what it finds: KG42x."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG420": CodeEntry(
        "unusable baseline",
        "The file of a baseline is missing, cannot be read, or is not what `kg lint --write-baseline` writes.",
        "Write it anew with `kg lint --write-baseline FILE`, and look at what has changed in it.",
    ),
    "KG421": CodeEntry(
        "unusable allowance",
        "An entry of the allow-list in kg.toml has no reason, no code that is known, or a key that means nothing.",
        "Give it a code of the findings (`kg explain KG401`) and the reason why it is right as it is.",
    ),
    "KG422": CodeEntry(
        "unknown launch file",
        "No launch file of the build is meant by this name, or several are.",
        "Give the path of the file, or its package and its path there; packages are read by `kg build`.",
    ),
}
