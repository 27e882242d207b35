"""Language models play: a server of the Model Context Protocol, over the JSON protocol of the page (docs/play/mcp.md)."""
