"""The quad store. Nothing here depends on ROS.

`kg.store.embedded.EmbeddedStore` is the local store; `kg.store.interface` is what the content of all stores has in
common. Nothing is imported here, so locating a store (`kg.store.layout`) does not load the engine.
"""
