PREFIX = "core"
STATUS = PREFIX + "/status"
