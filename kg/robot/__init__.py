"""Running robots: what their computation graph is, what they can do, and doing it.

`connection` is the one interface over all middlewares; nothing else in the room knows which one a robot speaks. What
comes in is a `ComputationGraph`, what rules make of it are the capabilities of `capability`, and what people compose
of these are the programs of `programs`.
"""
