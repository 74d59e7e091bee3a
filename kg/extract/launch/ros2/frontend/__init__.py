"""Readers of ROS 2 launch files in XML and YAML."""
