"""The gripper as the scripts see it."""

import rospy
from rover_core.srv import SetGripper, SetGripperRequest


class Gripper(object):
    """Opens and closes the gripper of an arm."""

    def __init__(self, arm="arm_server"):
        self._set_width = rospy.ServiceProxy(arm + "/set_gripper", SetGripper)

    def open(self):
        return self._set_width(SetGripperRequest.OPEN, 10.0)

    def close(self):
        return self._set_width(SetGripperRequest.CLOSED, 10.0)
