"""Search for nodes by function, inputs and outputs, and hardware, with reasons for each hit."""
