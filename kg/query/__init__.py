"""Evaluation of queries: guards, limits, formats, stored queries, reader processes."""
