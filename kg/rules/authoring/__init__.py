"""What writers of rules work with: examples, differences, dependencies, profiles, coverage; nothing here prints."""
