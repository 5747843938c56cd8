"""Raw records: reading them in any format, and finding the free decay in them."""
