"""Selection of projects in a table by criteria, with the figures of those that remain (RNKG, section 3.1)."""
