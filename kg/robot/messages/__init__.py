"""Message types and their values: definitions, defaults, validation, and the two encodings."""

from __future__ import annotations

from kg.robot.messages.types import Field, Types

__all__ = ["Field", "Types"]
