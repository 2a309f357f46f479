"""Pictures, pages and movies of recorded episodes."""
