#!/usr/bin/env python3
import py_trees
import py_trees_ros
import rclpy
from demo_msgs.action import Dock
from geometry_msgs.msg import Pose, Twist
from std_srvs.srv import Trigger


class Stop(py_trees.behaviour.Behaviour):
    def __init__(self, name, service):
        super().__init__(name)
        self.service = service

    def setup(self, **kwargs):
        self.node = kwargs["node"]
        self.client = self.node.create_client(srv_type=Trigger, srv_name=self.service)


class Pose2Blackboard(py_trees_ros.subscribers.ToBlackboard):
    def __init__(self, name, topic_name):
        super().__init__(name=name, topic_name=topic_name, topic_type=Pose, qos_profile=10, blackboard_variables="pose")


def make_tree():
    root = py_trees.composites.Sequence(name="all", memory=True)
    qos = py_trees_ros.utilities.qos_profile_unlatched()
    root.add_child(
        py_trees_ros.subscribers.EventToBlackboard(name="go", topic_name="/go", qos_profile=qos, variable_name="go")
    )
    root.add_child(Pose2Blackboard("pose", "/pose"))
    root.add_child(py_trees_ros.battery.ToBlackboard("battery", "/battery", qos, threshold=30.0))
    root.add_child(
        py_trees_ros.publishers.FromBlackboard(
            name="drive", topic_name="/cmd_vel", topic_type=Twist, qos_profile=qos, blackboard_variable="cmd"
        )
    )
    root.add_child(py_trees_ros.action_clients.FromConstant("dock", Dock, "/dock", Dock.Goal()))
    root.add_child(Stop("stop", "/stop"))
    return root


def main():
    rclpy.init()
    tree = py_trees_ros.trees.BehaviourTree(make_tree())
    tree.setup(timeout=15.0)
    rclpy.spin(tree.node)


main()
