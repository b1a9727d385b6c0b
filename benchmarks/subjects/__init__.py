"""What is compared: each module builds the implementations of one project for one robot."""
