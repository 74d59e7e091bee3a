"""Roslaunch XML: the nodes a ROS 1 launch file starts, by the rules of roslaunch's loader, without execution."""
