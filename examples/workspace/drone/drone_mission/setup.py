from glob import glob

from setuptools import find_packages, setup

package_name = "drone_mission"

setup(
    name=package_name,
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + package_name]),
        ("share/" + package_name, ["package.xml"]),
        ("share/" + package_name + "/launch", glob("launch/*")),
    ],
    install_requires=["setuptools"],
    maintainer="Drone Maintainers",
    maintainer_email="drone@example.org",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "mission = drone_mission.mission:main",
            "telemetry = drone_mission.telemetry:main",
        ],
    },
)
