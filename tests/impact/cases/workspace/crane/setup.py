from setuptools import setup

setup(
    name="crane",
    packages=["crane"],
    entry_points={"console_scripts": ["hoist = crane.hoist:main", "panel = crane.panel:main"]},
)
