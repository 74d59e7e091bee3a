"""Running robots: their computation graph, their capabilities, and executing these.

`connection` is the one interface over all middlewares; no other module depends on the middleware of a robot. A
`ComputationGraph` is the input, rules infer the capabilities of `capability`, and people compose them to the programs
of `programs`.
"""
