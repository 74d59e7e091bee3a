from actionlib import ActionServer


class AsyncActionServer:
    def __init__(self, name, spec):
        self.name, self.spec = name, spec

    async def start(self):
        self.server = ActionServer(self.name, self.spec, auto_start=False)
        self.server.start()
