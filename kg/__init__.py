"""`kg`: an embedded SPARQL triplestore with reasoning rules that knows ROS nodes and what robots can do with them."""
