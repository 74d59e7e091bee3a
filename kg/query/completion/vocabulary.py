"""Keywords and functions of SPARQL 1.1 with their descriptions."""

from __future__ import annotations

from types import MappingProxyType
from typing import Final, NamedTuple

KEYWORDS: Final = MappingProxyType(
    {
        "PREFIX": ("PREFIX ", "declares a prefix for IRIs"),
        "BASE": ("BASE <>", "declares what relative IRIs are relative to"),
        "SELECT": ("SELECT ", "answers rows"),
        "CONSTRUCT": ("CONSTRUCT {  } WHERE {  }", "answers a graph made from a template"),
        "ASK": ("ASK {  }", "answers whether anything matches"),
        "DESCRIBE": ("DESCRIBE ", "returns the triples about some resources"),
        "DISTINCT": ("DISTINCT ", "leaves out rows that occurred already"),
        "REDUCED": ("REDUCED ", "may leave out rows that occurred already"),
        "FROM": ("FROM ", "asks this graph alone"),
        "NAMED": ("NAMED ", "makes a graph one of those that GRAPH can name"),
        "WHERE": ("WHERE {  }", "the pattern that is looked for"),
        "OPTIONAL": ("OPTIONAL {  }", "keeps rows that this does not match"),
        "FILTER": ("FILTER()", "keeps the rows for which this is true"),
        "FILTER EXISTS": ("FILTER EXISTS {  }", "keeps the rows that this matches, binding nothing"),
        "FILTER NOT EXISTS": ("FILTER NOT EXISTS {  }", "keeps the rows that this does not match"),
        "UNION": ("UNION {  }", "matches either side"),
        "MINUS": ("MINUS {  }", "takes away the rows that this matches"),
        "BIND": ("BIND( AS ?)", "gives a variable the value of an expression"),
        "VALUES": ("VALUES ? {  }", "gives a variable each of some values"),
        "GRAPH": ("GRAPH ? {  }", "matches in one graph, or binds the graph"),
        "GROUP BY": ("GROUP BY ", "makes one row of all that are alike in this, for COUNT and such"),
        "HAVING": ("HAVING()", "keeps the groups for which this is true"),
        "ORDER BY": ("ORDER BY ", "sorts the rows"),
        "ASC": ("ASC()", "the smallest first"),
        "DESC": ("DESC()", "the largest first"),
        "LIMIT": ("LIMIT ", "answers at most so many rows"),
        "OFFSET": ("OFFSET ", "leaves out the first rows"),
        "EXISTS": ("EXISTS {  }", "is true when this matches"),
        "NOT EXISTS": ("NOT EXISTS {  }", "is true when this does not match"),
        "AS": ("AS ?", "names the value of the expression"),
        "IN": ("IN ()", "is one of these"),
        "NOT IN": ("NOT IN ()", "is none of these"),
        "UNDEF": ("UNDEF", "no value"),
    }
)
"""Inserted text and description of each keyword."""


class Function(NamedTuple):
    """The arguments of a function in SPARQL syntax, and a description of its result."""

    arguments: str
    sentence: str


AGGREGATES: Final = MappingProxyType(
    {
        "COUNT": Function("?x", "the number of rows that have a value"),
        "SUM": Function("?x", "the sum of numbers"),
        "MIN": Function("?x", "the least value"),
        "MAX": Function("?x", "the greatest value"),
        "AVG": Function("?x", "the mean of numbers"),
        "SAMPLE": Function("?x", "one of the values"),
        "GROUP_CONCAT": Function('?x; SEPARATOR=", "', "the values in one text"),
    }
)

FUNCTIONS: Final = MappingProxyType(
    {
        "STR": Function("term", "the text of a literal, or an IRI as text"),
        "LANG": Function("literal", "the language of a literal, empty without one"),
        "LANGMATCHES": Function("language, range", 'whether a language is of a range, such as "en" or "*"'),
        "DATATYPE": Function("literal", "the IRI of the type of a literal"),
        "BOUND": Function("?x", "whether a variable has a value"),
        "IRI": Function("text", "the IRI that a text is"),
        "BNODE": Function("", "a new blank node"),
        "COALESCE": Function("a, b", "the first that has a value"),
        "IF": Function("condition, then, else", "one of two values"),
        "SAMETERM": Function("a, b", "whether two terms are the very same"),
        "ISIRI": Function("term", "whether a term is an IRI"),
        "ISBLANK": Function("term", "whether a term is a blank node"),
        "ISLITERAL": Function("term", "whether a term is a literal"),
        "ISNUMERIC": Function("term", "whether a term is a number"),
        "REGEX": Function('text, "pattern", "i"', "whether a regular expression matches anywhere in a text"),
        "REPLACE": Function('text, "pattern", "replacement"', "a text with what matches replaced"),
        "CONTAINS": Function('text, "part"', "whether a text holds another"),
        "STRSTARTS": Function('text, "begin"', "whether a text begins with another"),
        "STRENDS": Function('text, "end"', "whether a text ends with another"),
        "STRBEFORE": Function('text, "part"', "the part before the first occurrence"),
        "STRAFTER": Function('text, "part"', "the part after the first occurrence"),
        "STRLEN": Function("text", "the number of characters"),
        "SUBSTR": Function("text, start, length", "a part of a text; the first character is 1"),
        "UCASE": Function("text", "a text in capital letters"),
        "LCASE": Function("text", "a text in small letters"),
        "CONCAT": Function("a, b", "texts joined"),
        "ENCODE_FOR_URI": Function("text", "a text encoded for an IRI"),
        "STRLANG": Function('text, "en"', "a literal with a language"),
        "STRDT": Function("text, type", "a literal with a type"),
        "ABS": Function("number", "a number without its sign"),
        "ROUND": Function("number", "the nearest whole number"),
        "CEIL": Function("number", "the next greater whole number"),
        "FLOOR": Function("number", "the next smaller whole number"),
        "RAND": Function("", "a number between 0 and 1 drawn by lot"),
        "NOW": Function("", "the time of the query"),
        "YEAR": Function("time", "the year of a time"),
        "MONTH": Function("time", "the month of a time"),
        "DAY": Function("time", "the day of a time"),
        "HOURS": Function("time", "the hours of a time"),
        "MINUTES": Function("time", "the minutes of a time"),
        "SECONDS": Function("time", "the seconds of a time"),
        "TIMEZONE": Function("time", "the time zone as a duration"),
        "TZ": Function("time", "the time zone as it is written"),
        "UUID": Function("", "a new IRI"),
        "STRUUID": Function("", "a new identifier as text"),
        "MD5": Function("text", "a checksum"),
        "SHA1": Function("text", "a checksum"),
        "SHA256": Function("text", "a checksum"),
        "SHA384": Function("text", "a checksum"),
        "SHA512": Function("text", "a checksum"),
    }
)
