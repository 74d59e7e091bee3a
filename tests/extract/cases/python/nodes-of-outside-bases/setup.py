from setuptools import setup

setup(name="demo", packages=["demo"], entry_points={"console_scripts": ["cook = demo.cook:main"]})
