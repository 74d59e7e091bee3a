import rospy
from std_msgs.msg import String
from tools.names import STATE


class Output(object):
    def __init__(self):
        self.publisher = rospy.Publisher(STATE, String, queue_size=1)
