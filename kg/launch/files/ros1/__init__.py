"""Roslaunch XML: what a ROS 1 launch file starts, by the rules of roslaunch's own loader, with nothing executed."""
