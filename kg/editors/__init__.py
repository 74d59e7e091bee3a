"""The language server: rules as they are typed, and the findings of `kg lint` in the files of a workspace."""
