import os
from glob import glob

from setuptools import setup

package_name = "robot"
setup(
    name=package_name,
    data_files=[
        ("share/" + package_name, ["package.xml"]),
        (os.path.join("share", package_name, "launch"), glob(os.path.join("bringup", "*.launch.xml"))),
        (f"share/{package_name}", ["single/alone.launch.xml"]),
    ],
)
