"""What is wrong with rules before they run: one check a file, each with its code."""
