"""What joins emitters and an archive."""
