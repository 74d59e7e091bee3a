from setuptools import setup

setup(name="demo", packages=["demo"], entry_points={"console_scripts": ["bus = demo.bus:main"]})
