"""How bad a remark is: of `kg lint`, of `kg rules check`, and in the header of a rule."""

from __future__ import annotations

from typing import Final

__all__ = ["SEVERITIES"]

SEVERITIES: Final = ("error", "warning", "note")
"""From the worst to the least."""
