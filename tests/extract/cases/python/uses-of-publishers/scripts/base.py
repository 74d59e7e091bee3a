class Base:
    def report(self, text):
        self.inherited.publish(text)

    def learn(self, text):
        self.text = text
