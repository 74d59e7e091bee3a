#!/usr/bin/env python3

import rospy
from std_msgs.msg import String


class Unused:
    def __init__(self):
        rospy.Publisher("unused", String, queue_size=1)


def helper():
    Unused()
    rospy.Publisher("helper", String, queue_size=1)


class Used:
    def __init__(self):
        rospy.Timer(rospy.Duration(1), self.tick)
        rospy.on_shutdown(stop)

    def tick(self, event):
        rospy.Publisher("ticks", String, queue_size=1)

    def other(self):
        rospy.Publisher("other", String, queue_size=1)


def stop():
    rospy.Publisher("stopped", String, queue_size=1)


if __name__ == "__main__":
    rospy.init_node("part")
    Used()
