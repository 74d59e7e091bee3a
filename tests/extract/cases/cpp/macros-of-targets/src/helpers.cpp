// Code without nodes.
