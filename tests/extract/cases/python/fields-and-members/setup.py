from setuptools import setup

setup(
    name="fields_and_members",
    version="1.0.0",
    packages=["fields_and_members"],
    entry_points={"console_scripts": ["lights = fields_and_members.lights:main"]},
)
