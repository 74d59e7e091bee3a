#!/usr/bin/env python
import rospy
from std_msgs.msg import String
from std_srvs.srv import Empty, Trigger


class Watch(object):
    def __init__(self):
        self.left = False
        self.limits = self.find_limits()
        rospy.Subscriber("place", String, self.on_place)
        rospy.Timer(rospy.Duration(1), self.on_timer)

    def find_limits(self):
        try:
            return rospy.ServiceProxy("limits", Trigger)().limits
        except rospy.ServiceException:
            return []

    def on_place(self, message):
        self.left = message.data in self.limits

    def on_timer(self, event):
        if self.left:
            rospy.ServiceProxy("stop", Empty)()


if __name__ == "__main__":
    rospy.init_node("watch")
    Watch()
    rospy.spin()
