"""How is work of many independent parts played on one machine or on many? By the same code, to the same
bits."""
