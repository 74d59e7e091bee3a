"""The store of quads. Nothing here knows of ROS."""
