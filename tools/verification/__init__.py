"""What tools/verify is made of."""
