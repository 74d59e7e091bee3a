"""Serialization of results as streams: rows (`rows`), graphs (`graphs`) and single terms (`values`).

`kg.query.formats` selects a format by name, and is the interface for other packages.
"""
