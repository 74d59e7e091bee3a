"""From sources to the store: what to read again, in which process, and how the result replaces the old one."""
