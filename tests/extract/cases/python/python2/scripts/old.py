#!/usr/bin/env python
import rospy
from std_msgs.msg import Int32, String


class Old:
    def __init__(self, (low, high), name=ur"old_topic"):
        print "limits", low, `high`
        exec "pass" in {}
        try:
            self.pub = rospy.Publisher(name, String)
        except rospy.ROSException, error:
            print >>open("/dev/null", "w"), error
        if low <> high:
            rospy.Subscriber(u"count", Int32, self.heard)

    def heard(self, message):
        pass


if __name__ == '__main__':
    rospy.init_node('old')
    Old((1, 0777))
    rospy.spin()
