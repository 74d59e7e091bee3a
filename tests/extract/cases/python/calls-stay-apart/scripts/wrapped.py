#!/usr/bin/env python3

import rospy
from std_msgs.msg import Bool, Float64, String


def publish(name, kind=String, prefix="out"):
    return rospy.Publisher("/".join([prefix, name]), kind, queue_size=1)


class Joint:
    def __init__(self, name, kind, **options):
        self.name = name
        self.kind = kind
        self.pub = self.make("command", **options)

    def make(self, suffix, latch=False):
        return rospy.Publisher(self.name + "/" + suffix, self.kind, latch=latch, queue_size=1)


class Gripper(Joint):
    def __init__(self, *args):
        super().__init__(*args)
        rospy.Publisher(self.name + "/force", Float64, queue_size=1)


if __name__ == "__main__":
    rospy.init_node("wrapped")
    publish("a", Bool)
    publish("b", prefix="other")
    Joint("arm", Float64, latch=True)
    Joint(kind=Bool, name="door")
    Gripper("hand", String)
