"""How is work that is made of many independent parts played on one machine or on many? With the same code, and the same results."""
