#!/usr/bin/env python
print "old"
