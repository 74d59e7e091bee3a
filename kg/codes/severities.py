"""Severities of remarks by `kg lint`, `kg rules check` and headers of rules."""

from __future__ import annotations

from typing import Final

SEVERITIES: Final = ("error", "warning", "note")
"""From most to least severe."""
