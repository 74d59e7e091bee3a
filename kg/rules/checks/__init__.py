"""Checks of rules before they run: one function a check, by what it looks at."""
