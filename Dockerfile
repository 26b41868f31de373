# The program and its manifests on Debian 12:
#   docker build -t shearcell .
#   docker run --rm -v "$PWD:/work" shearcell run /usr/share/shearcell/experiments/drag.yaml --scale smoke
FROM debian:12-slim AS build
COPY . /source
WORKDIR /source
RUN sh .ci/setup \
 && apt-get install -q -y --no-install-recommends dpkg-dev file git help2man nodejs npm \
 && cmake --preset release -DSHEARCELL_TESTS=OFF \
 && cmake --build --preset release \
 && cd build/release && cpack -B /package

FROM debian:12-slim
COPY --from=build /package/*.deb /package/
RUN apt-get update -q && apt-get install -q -y /package/*.deb \
 && rm -rf /package /var/lib/apt/lists/*
WORKDIR /work
ENTRYPOINT ["shearcell"]
