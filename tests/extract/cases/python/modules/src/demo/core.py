import rospy
import std_msgs.msg as messages
from demo import names
from demo.base import Base


class Core(Base):
    topic = names.STATUS

    def __init__(self, robot):
        Base.__init__(self)
        self.robot = robot
        rospy.Subscriber(self.input_name, messages.Bool, lambda message: None)

    @property
    def input_name(self):
        return self.robot + "/in"

    def service(self):
        return "do_it"


def never_called():
    rospy.Publisher("never", messages.Bool, queue_size=1)
