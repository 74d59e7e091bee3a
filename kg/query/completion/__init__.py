"""What may stand at a place of a query that is being written, from its grammar and from what the store holds.

    outline    reads a query, broken or not: its triple patterns, and what is expected at any place
    typed      what is being typed at a position, and which part of the text it replaces
    statistics which classes and properties the store has, which go together, and how often
    names      the values that properties have, where these are few
    meaning    which classes the variables of a query stand for
    matching   how well a candidate fits what was typed
    candidates what is offered at each kind of place
    service    `complete`, which puts these together

Nothing here knows of ROS: a class is known by its instances, a name by its label.
"""
