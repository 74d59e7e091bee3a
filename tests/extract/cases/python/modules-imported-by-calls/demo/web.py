import uvicorn


def main():
    uvicorn.run("demo.api:app", host="0.0.0.0", port=8080)
