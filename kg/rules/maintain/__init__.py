"""Incremental maintenance of inferred triples under insertions and deletions."""

from __future__ import annotations

from kg.rules.maintain.maintaining import Change, Maintained

__all__ = ["Change", "Maintained"]
