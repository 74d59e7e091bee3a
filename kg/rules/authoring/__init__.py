"""Tools for authors of rules: examples, differences, dependencies, profiles, coverage. Nothing here prints."""
