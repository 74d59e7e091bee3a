"""The one evaluator of expressions in launch files: of XML, YAML, `$(eval)`, xacro and Python."""
