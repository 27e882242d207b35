"""How does an agent interact with the table? The Gymnasium environments and their parts."""
