class Base:
    def report(self, text):
        self.inherited.publish(text)
