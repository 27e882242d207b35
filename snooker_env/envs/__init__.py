"""How does an agent meet the table? The Gymnasium environments and their parts."""
