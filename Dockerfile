# The program on Debian 12, installed from its own package:
#   docker build -t leviosim . && docker run --rm -v "$PWD":/work leviosim run --out run
FROM debian:12 AS build
WORKDIR /leviosim
COPY . .
RUN tools/setup.sh && apt-get install -y --no-install-recommends dpkg-dev file \
  && tools/build.sh release leviosim leviosim_library && cd build/release && cpack

FROM debian:12
COPY --from=build /leviosim/build/release/*.deb /packages/
RUN apt-get update && apt-get install -y --no-install-recommends /packages/leviosim_*.deb \
  && rm -rf /var/lib/apt/lists/*
WORKDIR /work
ENTRYPOINT ["leviosim"]
