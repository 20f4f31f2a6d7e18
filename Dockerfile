# ryusa in a container, from the wheels of `make packages`:
#   docker build -t ryusa .
#   docker run --rm -v "$PWD:/work" --user "$(id -u):$(id -g)" ryusa run case.toml
FROM python:3.13-slim
COPY dist/ryusa-*.whl dist/ryusa_studies-*.whl constraints.txt /wheels/
RUN pip install --no-cache-dir --constraint /wheels/constraints.txt /wheels/*.whl \
    && rm -r /wheels
# compiled code is kept here, whoever runs it
ENV RYUSA_CACHE=/var/cache/ryusa MPLCONFIGDIR=/var/cache/ryusa/matplotlib
RUN mkdir -p "$RYUSA_CACHE" && chmod 1777 "$RYUSA_CACHE"
WORKDIR /work
USER 1000
ENTRYPOINT ["ryusa"]
