"""The store of quads. Nothing here knows of ROS.

`kg.store.embedded.EmbeddedStore` is the store on this machine; `kg.store.interface` says what any store gives.
Nothing is imported here, so that looking where a store stands (`kg.store.layout`) costs no engine.
"""
