from setuptools import setup

setup(name="sensor", packages=["sensor"], entry_points={"console_scripts": ["sensor = sensor.node:main"]})
