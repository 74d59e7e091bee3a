import importlib


def main():
    importlib.import_module("demo.bridge").Bridge().call("stop")
