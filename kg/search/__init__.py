"""Finding nodes by function, inputs and outputs, and hardware; with the reasons of each hit."""
