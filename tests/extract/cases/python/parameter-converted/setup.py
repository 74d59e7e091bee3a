from setuptools import setup

setup(
    name="converted",
    packages=["converted"],
    entry_points={"console_scripts": ["converted = converted.node:main"]},
)
