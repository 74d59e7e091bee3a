"""The screens of the shell: the main one, and those above it."""
