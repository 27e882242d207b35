# The clone, installed and with its kernels compiled. docs/scale.md says how it is used.
FROM python:3.13-slim
ARG EXTRAS=train
ARG MORE=""
# torch for processors alone: a tenth of the size
ENV PIP_EXTRA_INDEX_URL=https://download.pytorch.org/whl/cpu
# with wget KubeRay asks whether a node lives
RUN apt-get update && apt-get install -y --no-install-recommends wget && rm -rf /var/lib/apt/lists/*
# a user of its own: a kernel cache that others can write to is not read
RUN useradd --create-home player && install -d -o player /home/player/snooker_env
USER player
WORKDIR /home/player/snooker_env
COPY --chown=player . .
ENV PATH=/home/player/venv/bin:$PATH NUMBA_CACHE_DIR=/home/player/kernels
RUN python -m venv /home/player/venv && pip install --no-cache-dir -e ".[$EXTRAS]" $MORE
RUN python -c "import snooker_env; snooker_env.warmup()"
CMD ["python"]
