"""Rules as blocks: a tree for editors, its JSON form, and its translation to and from `.rq`.

    tree -> text     kg.rules.blocks.write
    text -> tree     kg.rules.blocks.read

SPARQL without a block of its own is kept as text (`Other`, `Formula`), so every `.rq` can be shown.
"""
