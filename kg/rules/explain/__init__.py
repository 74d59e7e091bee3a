"""Why a fact holds, and why one does not: computed from the data on request, down to the line of code."""
