"""Launch files are evaluated without running anything: ROS 1 XML, and ROS 2 XML, YAML and Python."""
