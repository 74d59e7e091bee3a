"""The quad store. Nothing here depends on ROS.

`kg.store.embedded.EmbeddedStore` is the local store; `kg.store.interface` is the interface of all stores. Nothing is
imported here, so locating a store (`kg.store.layout`) does not load the engine.
"""
