"""What the scripts of the rover share."""
