"""Why a fact holds, and why one does not: computed from the data when asked, down to the line of code."""
