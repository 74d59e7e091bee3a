from .model import Model


class Plain(Model):
    LABEL = 'plain'
