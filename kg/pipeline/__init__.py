"""From sources to the store: what to read again, in which process, and how the result takes the place of the old."""
