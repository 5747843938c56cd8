"""The catalogue of possible causes, one file each, on one interface (`mechanism.Mechanism`)."""
