"""Answers as text while they are found: rows (`rows`) and graphs (`graphs`), and how single terms are read (`values`).

`kg.query.formats` knows the formats by name, and is what others use.
"""
