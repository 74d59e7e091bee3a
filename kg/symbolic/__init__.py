"""A forward abstract interpreter: runs an intermediate form, and records the effects of framework calls."""
