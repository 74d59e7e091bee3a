"""ROS 2 launch: three languages become one tree of actions, which is executed symbolically."""
