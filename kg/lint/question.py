"""The settings of `kg lint`: flags, variables `KG_LINT_...` and the table `[lint]` of `kg.toml`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from kg import forms
from kg.codes import SEVERITIES
from kg.settings import declared, setting


@dataclass(frozen=True, slots=True)
class Question:
    """The selection of findings.

    `launch` names a launch file, `arguments` and `environment` are its inputs; `package` is the package of launch files
    to check. With `variants`, findings of variants of the launch file are added.
    """

    launch: str | None = None
    package: str | None = None
    codes: tuple[str, ...] = setting(
        (),
        forms.codes,
        "CODE",
        "Show only findings with this code; may be repeated.",
        option="code",
        several=True,
    )
    level: str = setting(
        SEVERITIES[-1],
        forms.one_of(*SEVERITIES),
        "SEVERITY",
        f"Lowest severity to show: {', '.join(SEVERITIES[:-1])} or {SEVERITIES[-1]}.",
    )
    every: bool = setting(
        False,
        forms.switch,
        "",
        "Include findings that might only arise because a file is meant to be included.",
        option="all",
        short="-a",
    )
    baseline: Path | None = setting(None, forms.path, "FILE", "Hide the findings listed in this file.")
    arguments: Mapping[str, str] = field(default_factory=dict)
    environment: Mapping[str, str] = field(default_factory=dict)
    variants: bool = False


DECLARED: Final = declared(Question, "lint")
