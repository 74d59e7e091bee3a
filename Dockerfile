# kg in a container: `docker build -t kg .`, then see docs/install.md#container.
FROM python:3.12-slim-bookworm AS build
# npm installs the libraries of the pages (hatch_build.py). Debian removes old versions, so a pinned one stops to build.
# hadolint ignore=DL3008
RUN apt-get update \
 && apt-get install -y --no-install-recommends npm \
 && rm -rf /var/lib/apt/lists/*
WORKDIR /src
COPY . .
RUN python -m venv /opt/kg \
 && KG_REQUIRE_LIBRARIES=1 /opt/kg/bin/pip install --no-cache-dir '.[lsp,mcp]'

FROM python:3.12-slim-bookworm
# kg calls git for commits, remotes and sources that are addresses.
# hadolint ignore=DL3008
RUN apt-get update \
 && apt-get install -y --no-install-recommends git \
 && rm -rf /var/lib/apt/lists/* \
 && useradd --uid 1000 --home-dir /var/lib/kg --create-home kg \
 && chmod 1777 /var/lib/kg
COPY --from=build /opt/kg /opt/kg
# Open to every user, because `docker run --user` names the owner of the mounted folder.
ENV HOME=/var/lib/kg PATH=/opt/kg/bin:$PATH
USER 1000
WORKDIR /workspace
EXPOSE 7878
ENTRYPOINT ["kg"]
CMD ["--help"]
