from setuptools import setup

setup(name="bridge", packages=["bridge"], entry_points={"console_scripts": ["bridge = bridge.bridge:main"]})
