#!/usr/bin/env python
from types import SimpleNamespace

import rospy
from attrdict import AttrDict
from geometry_msgs.msg import Twist
from std_msgs.msg import Bool, Float32

TYPES = {"twist": Twist, "number": Float32}
SETTINGS = AttrDict({
    "inputs": [{"topic": "/cart/command", "type": "twist"}],
    "outputs": [
        {"topic": "/cart/speed", "type": "number", "name": "speed"},
        {"topic": "/cart/motion", "type": "twist", "name": "motion"},
    ],
})
NAMES = SimpleNamespace(ready="/cart/ready")


def main():
    rospy.init_node("bridge")
    for one in SETTINGS.inputs:
        rospy.Subscriber(one.topic, TYPES[one.type], rospy.loginfo)
    publishers = {one.name: rospy.Publisher(one.topic, TYPES[one.type], queue_size=1) for one in SETTINGS.outputs}
    publishers["ready"] = rospy.Publisher(NAMES.ready, Bool, queue_size=1)
    rospy.spin()


if __name__ == "__main__":
    main()
