"""The one way a query is run: guards, limits, formats, stored queries."""
