"""Descriptions of nodes and packages (RNKG, section 3.2.3): comments, manifests, pages, launch files, wiki."""

from kg.extract.texts.describing import read_descriptions

__all__ = ["read_descriptions"]
