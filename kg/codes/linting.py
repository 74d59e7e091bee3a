"""The codes of `kg lint` itself, separate from its findings: KG42x."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG420": CodeEntry(
        "unusable baseline",
        "The baseline file is missing, unreadable, or not in the format of `kg lint --write-baseline`.",
        "Write it again with `kg lint --write-baseline FILE`, and review the changes.",
    ),
    "KG421": CodeEntry(
        "unusable allowance",
        "An entry of the allow-list in kg.toml has no reason, an unknown code or an unknown key.",
        "Give the entry a code of a finding (`kg explain KG401`) and the reason for accepting it.",
    ),
    "KG422": CodeEntry(
        "unknown launch file",
        "The name matches no launch file of the build, or several.",
        "Give the path of the file, or its package and the path in it. Packages are read by `kg build`.",
    ),
}
