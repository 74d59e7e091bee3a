"""The store of quads. Nothing here depends on ROS.

`kg.store.embedded.EmbeddedStore` is the store on this machine; `kg.store.interface` is the interface of all stores.
Nothing is imported here: locating a store (`kg.store.layout`) loads no engine.
"""
