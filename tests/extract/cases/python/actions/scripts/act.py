#!/usr/bin/env python3

import actionlib
import rospy
from actionlib_msgs.msg import *
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from control_msgs.msg import FollowJointTrajectoryAction as Follow


class Server(actionlib.SimpleActionServer):
    def __init__(self):
        actionlib.SimpleActionServer.__init__(self, "~follow", Follow, self.run, auto_start=False)

    def run(self, goal):
        client = actionlib.SimpleActionClient("move_base", MoveBaseAction)
        client.send_goal(MoveBaseGoal())


if __name__ == "__main__":
    rospy.init_node("act")
    Server().start()
    rospy.Subscriber("status", GoalStatusArray, print)
