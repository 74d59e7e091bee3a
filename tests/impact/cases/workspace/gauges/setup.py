from setuptools import setup

setup(
    name="gauges",
    packages=["gauges"],
    entry_points={"console_scripts": ["dial = gauges.dial:main"]},
)
