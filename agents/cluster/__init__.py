"""How is work of independent parts played on one machine or on many? By the same code, to the same bits."""
