#!/usr/bin/env python
import rospy
from base import Base
from nav_msgs.msg import Odometry
from std_msgs.msg import String


class Driver(Base):
    def __init__(self):
        self.unused = rospy.Publisher("unused", String, queue_size=1)  # self.unused.publish(x)
        self.answer = rospy.Publisher("answer", String, queue_size=1)
        self.timed = rospy.Publisher("timed", String, queue_size=1)
        self.inherited = rospy.Publisher("inherited", String, queue_size=1)
        self.odometry = rospy.Publisher("odom", Odometry, queue_size=1)
        rospy.Subscriber("firmware", String, self.firmware)
        rospy.Subscriber("printed", String, self.printed)
        rospy.Subscriber("overridden", String, self.learn)
        rospy.Timer(rospy.Duration(1), self.tick)

    def firmware(self, text):
        self.reply(text)

    def printed(self, text):
        """Nothing yet."""
        rospy.loginfo("heard %s", str(text.data))
        pass

    def learn(self, text):
        pass

    def reply(self, text):
        self.answer.publish(text)
        self.timed.publish(text)

    def tick(self, _):
        self.timed.publish(String())
        message = Odometry()
        message.pose.pose.position.x = 1.5
        self.odometry.publish(message)


if __name__ == "__main__":
    rospy.init_node("driver")
    Driver()
    rospy.spin()
