"""Rules as blocks: a tree for people who compose them, its JSON form, the `.rq` that says the same, and the way back.

    tree -> text     kg.rules.blocks.write
    text -> tree     kg.rules.blocks.read

What has no block of its own is kept as SPARQL inside one (`Other`, `Formula`), so that every `.rq` can be shown.
"""
