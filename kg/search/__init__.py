"""Finding nodes: by what they do, what goes in and out, what hardware they work with; with the reasons of each hit."""
