"""ROS 2 launch files in Python, read without running them, on the interpreter of `kg.symbolic`."""
