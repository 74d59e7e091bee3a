"""Checks of rules before they run: one module a check, each with its code."""
