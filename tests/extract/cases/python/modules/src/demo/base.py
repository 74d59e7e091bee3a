import rospy
from std_msgs.msg import String as Text


class Base(object):
    topic = "base"

    def __init__(self):
        self.pub = rospy.Publisher(self.topic, Text, queue_size=1)
        self.timer = rospy.Timer(rospy.Duration(1), self.tick)

    def tick(self, event):
        rospy.ServiceProxy(self.service(), __import__("x").Y)

    def service(self):
        raise NotImplementedError

    def unused_helper(self):
        pass
