"""The lesson's source, read by machines: its regions; its steps as loops and as JavaScript."""
