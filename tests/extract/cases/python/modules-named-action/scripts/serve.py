#!/usr/bin/env python3
import asyncio

import asynced
import rospy
from actionlib.msg import TestAction
from asynced.srv import offer
from std_srvs.srv import Empty

rospy.init_node("serve")
offer("reset", Empty)
asyncio.run(asynced.AsyncActionServer("dock", TestAction).start())
