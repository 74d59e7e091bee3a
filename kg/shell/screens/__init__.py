"""The screens of the shell: the main one, and those that open above it."""
