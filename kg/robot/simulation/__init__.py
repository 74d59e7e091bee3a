"""Simulated robots: worlds of pybullet, with nodes that make them ROS robots.

`plan` reads the worlds, which are data files; `scene`, `wheeled`, `drone` and `arm` are physics and sensors; `nodes`,
`arm_nodes` and `navigating` are the nodes over `kg.robot.connection`; `running` advances time. Only `scene` loads
pybullet and OpenCV (the extra `simulate`).
"""
