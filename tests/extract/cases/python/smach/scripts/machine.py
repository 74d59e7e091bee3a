#!/usr/bin/env python3

import rospy
import smach
import smach_ros
from control_msgs.msg import SingleJointPositionAction
from move_base_msgs.msg import MoveBaseAction
from std_msgs.msg import Empty
from std_srvs.srv import Trigger


class Wait(smach.State):
    def __init__(self):
        smach.State.__init__(self, outcomes=["done"])
        self.pub = rospy.Publisher("waiting", Empty, queue_size=1)

    def execute(self, userdata):
        rospy.wait_for_message("go", Empty)
        return "done"


def main():
    rospy.init_node("machine")
    machine = smach.StateMachine(outcomes=["done"])
    with machine:
        smach.StateMachine.add("WAIT", Wait(), transitions={"done": "MOVE"})
        smach.StateMachine.add("MOVE", smach_ros.SimpleActionState("move_base", MoveBaseAction))
        smach.StateMachine.add("CALL", smach_ros.ServiceState("finish", Trigger))
    server = smach_ros.IntrospectionServer("server", machine, "/ROOT")
    server.start()
    wrapper = smach_ros.ActionServerWrapper("command", SingleJointPositionAction, wrapped_container=machine)
    wrapper.run_server()
    machine.execute()


if __name__ == "__main__":
    main()
