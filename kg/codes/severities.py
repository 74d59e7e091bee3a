"""Severities of remarks by `kg lint`, `kg rules check` and headers of rules."""

from __future__ import annotations

from typing import Final

__all__ = ["SEVERITIES"]

SEVERITIES: Final = ("error", "warning", "note")
"""From most to least severe."""
