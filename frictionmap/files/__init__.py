"""Files: configurations read, datasets written whole or not at all, read with a check, and put in words."""
