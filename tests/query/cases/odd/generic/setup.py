from setuptools import setup

setup(name="generic", packages=["generic"], entry_points={"console_scripts": ["listen = generic.listen:main"]})
