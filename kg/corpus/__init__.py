"""Stage 1: which repositories, which packages, which files."""
