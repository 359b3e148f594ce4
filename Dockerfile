# Passes the two commands of README: docker build -t hav_env . && docker run --rm hav_env
FROM python:3.12-slim-bookworm

# a browser plays replay pages in the tests; git names the revision in results; g++ is a yardstick's
RUN apt-get update \
    && apt-get install -y --no-install-recommends chromium chromium-driver git g++ \
    && rm -rf /var/lib/apt/lists/*

# compiled code is kept in a folder that belongs to the user
RUN useradd --create-home driver
USER driver
WORKDIR /home/driver/hav_env
COPY --chown=driver . .
ENV SDL_VIDEODRIVER=dummy

RUN python3 -m venv .venv && .venv/bin/pip install -q -e '.[all]' && .venv/bin/python -m baselines reproduce
RUN python3 -m venv .venv && .venv/bin/pip install -q -e '.[all]' && .venv/bin/python -m pytest -n 2

ENV PATH="/home/driver/hav_env/.venv/bin:$PATH"
CMD ["hav-env", "list"]
