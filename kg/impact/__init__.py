"""What would break if a name of a system were renamed, removed or changed, with the lines to look at."""
