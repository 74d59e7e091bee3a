"""Diagnostics of queries (`problems`): errors, then warnings, with ranges of characters and fixes."""
