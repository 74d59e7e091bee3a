"""Robots to try things on: worlds of pybullet, and the nodes that make robots of ROS of them.

`plan` reads worlds, which are data; `scene`, `wheeled` and `drone` are the physics and sensors; `nodes` and
`navigating` are the faces through `kg.robot.connection`; `running` moves time. pybullet and OpenCV (the extra
`simulate`) are loaded by `scene` alone.
"""
