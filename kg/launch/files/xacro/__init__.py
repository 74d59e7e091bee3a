"""Robot descriptions written with xacro, evaluated without running anything, and the plugins of a simulator in them."""
