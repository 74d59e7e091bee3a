"""Stage 1: repositories, packages and files."""
