#!/usr/bin/env python3

import rospy
from jsk_topic_tools import ConnectionBasedTransport
import message_filters
from sensor_msgs.msg import Image


class Filter(ConnectionBasedTransport):
    def __init__(self):
        super(Filter, self).__init__()
        self.pub = self.advertise("~output", Image, queue_size=1)

    def subscribe(self):
        self.left = message_filters.Subscriber("~left", Image)
        self.right = message_filters.Subscriber("~right", Image, queue_size=1)

    def unsubscribe(self):
        self.left.sub.unregister()


if __name__ == "__main__":
    rospy.init_node("filter")
    Filter()
    rospy.spin()
