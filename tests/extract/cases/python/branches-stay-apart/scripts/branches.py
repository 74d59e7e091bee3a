#!/usr/bin/env python3

import sys

import rospy
from sensor_msgs.msg import CompressedImage, Image

rospy.init_node("branches")
if len(sys.argv) > 1:
    topic = "image/compressed"
    kind = CompressedImage
elif rospy.get_param("~raw", True):
    topic, kind = "image", Image
else:
    if topic_given:
        topic = "other"
    else:
        topic = "another"
    kind = Image
rospy.Subscriber(topic, kind, print)


def listen(verbose):
    if verbose:
        rospy.Subscriber("verbose", Image, print)
    else:
        rospy.Subscriber("quiet", Image, print)


listen(False)
name = "x" if kind is Image else "y"
rospy.Publisher(name, Image, queue_size=1)
