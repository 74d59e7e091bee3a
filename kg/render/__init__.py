"""What faces share to show things to people: text made safe, pictures. Nothing here reads a store."""
