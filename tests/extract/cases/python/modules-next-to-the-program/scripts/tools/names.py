STATE = "%s/state" % "arm"
