from setuptools import setup

setup(
    name="demo",
    packages=["demo"],
    entry_points={"console_scripts": ["sail = demo.sail:main", "buoy = demo.buoy:main"]},
)
