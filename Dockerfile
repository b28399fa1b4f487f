# The program in a container; --user lets it write into your folder, and makes the results yours:
# docker build -t gladstone . && docker run --rm --user "$(id -u):$(id -g)" -v "$PWD:/data" gladstone render bos.toml -o out
FROM debian:bookworm-slim AS build
RUN apt-get update && apt-get install -y --no-install-recommends make git ca-certificates && rm -rf /var/lib/apt/lists/*
COPY . /gladstone
WORKDIR /gladstone
RUN make package CMAKE_OPTIONS=-DGLADSTONE_BUILD_TESTS=OFF && cp build/gladstone_*.deb /gladstone.deb

FROM debian:bookworm-slim
COPY --from=build /gladstone.deb /tmp/gladstone.deb
# gnuplot and its font draw the figures
RUN apt-get update && \
    apt-get install -y --no-install-recommends /tmp/gladstone.deb gnuplot-nox fonts-dejavu-core && \
    rm -rf /var/lib/apt/lists/* /tmp/gladstone.deb
RUN useradd --create-home --uid 1000 gladstone && mkdir /data && chown gladstone:gladstone /data
USER gladstone
WORKDIR /data
ENTRYPOINT ["gladstone"]
CMD ["--help"]
