from setuptools import setup

setup(name="makers", packages=["makers"], entry_points={"console_scripts": ["makers = makers.node:main"]})
