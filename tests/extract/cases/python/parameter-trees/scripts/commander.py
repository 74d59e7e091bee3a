#!/usr/bin/env python

import operator

import rospy
from std_msgs.msg import Bool, Float64, String


class Commander(object):
    def __init__(self):
        rospy.init_node("commander")
        left = self.wheel("left")
        right = self.wheel("right")
        self.left = make(left)
        self.right = make(right)
        for shock in rospy.get_param("~shocks", []):
            rospy.Publisher(shock["name"] + "/command", Float64, queue_size=1)
        priorities = rospy.get_param("~priorities", [])
        self.priorities = sorted(priorities.items(), key=operator.itemgetter(1))
        for name, priority in self.priorities:
            rospy.Subscriber("/" + name + "/chosen", String, print)
        names = rospy.get_param("~names")
        for index in range(len(names)):
            rospy.Subscriber(names[index], Bool, print)
        arms = rospy.get_param("~arms")
        for arm in arms:
            rospy.Publisher(arms[arm].get("topic", "arm"), Bool, queue_size=1)
        own = rospy.get_namespace()
        rospy.Publisher(own + "status", String, queue_size=1)
        rospy.Publisher("%s/mode" % own.rstrip("/"), String, queue_size=1)
        rospy.Publisher("/all" + own + "report", String, queue_size=1)

    def wheel(self, side):
        prefix = "~" + side + "/"
        return rospy.get_param(prefix + "controller", None)


def make(controller):
    if not controller:
        return None
    return rospy.Publisher(controller + "/command", Float64, queue_size=1)


if __name__ == "__main__":
    Commander()
    rospy.spin()
