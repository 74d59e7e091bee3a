from fastapi import FastAPI

from demo.bridge import Bridge

app = FastAPI()
bridge = Bridge()


@app.get("/start")
def start():
    bridge.call("start")


@app.get("/{name}")
def any_of(name: str):
    bridge.call(f"tasks/{name}")
