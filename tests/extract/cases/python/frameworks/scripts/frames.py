#!/usr/bin/env python3

import diagnostic_updater
import dynamic_reconfigure.client
from dynamic_reconfigure.server import Server
import rospy
import tf
import tf2_ros
from demo.cfg import LimitsConfig

rospy.init_node("frames")
tf.TransformListener()
tf2_ros.StaticTransformBroadcaster()
diagnostic_updater.Updater()
Server(LimitsConfig, lambda config, level: config)
