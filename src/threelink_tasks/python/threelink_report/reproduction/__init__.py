"""The paper, made again: stages that run the product's tools, and what is drawn of their files."""
