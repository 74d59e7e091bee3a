"""ROS 2 launch files in Python, read without running them."""
