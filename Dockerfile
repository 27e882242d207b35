# snooker_env from this source, its kernels compiled. docs/scale.md says how it is used.
#   docker build -t snooker_env .
#   docker run --rm snooker_env python -m snooker_env.benchmark tasks
FROM python:3.13-slim AS build
COPY . /source
RUN pip wheel --no-deps --wheel-dir /wheels /source

FROM python:3.13-slim
# as "[train]"; with nothing, gymnasium, numpy and numba alone
ARG EXTRAS=""
RUN useradd --create-home player
COPY --from=build /wheels /wheels
RUN pip install --no-cache-dir "$(echo /wheels/*.whl)$EXTRAS"
# who runs them: a cache that others can write to is not read
USER player
WORKDIR /home/player
ENV NUMBA_CACHE_DIR=/home/player/kernels
RUN python -c "import snooker_env; snooker_env.warmup()"
CMD ["python"]
