"""From the text of a rule to a syntax tree: SPARQL 1.1 CONSTRUCT and SPARQL 1.2 RL, whose grammars share most."""
