#!/usr/bin/env python3

import rospy
from lib.transport import Transport
from std_msgs.msg import String


class Relay(Transport):
    def __init__(self):
        super(Relay, self).__init__()
        self.pub = self.advertise("~output", String, queue_size=1)

    def subscribe(self):
        self.sub = rospy.Subscriber("~input", String, self.pub.publish)


if __name__ == "__main__":
    rospy.init_node("relay")
    relay = Relay()
    rospy.spin()
