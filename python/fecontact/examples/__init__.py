"""Examples to run and to read: ``python -m fecontact.examples.block_on_ground``."""
