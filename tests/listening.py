import json


class Heard:
    """A playground (of class ``kind``) whose browser is a list."""

    kind = None

    def __init__(self, *arguments, **options):
        self.playground = self.kind(*arguments, **options)
        self.messages = []
        self.playground.send = lambda content, buffers=None: self.messages.append((json.loads(json.dumps(content)), buffers))

    def say(self, type, **rest):
        self.playground._answer(self.playground, {"type": type, **rest}, [])
        return self.messages[-1] if self.messages else None
