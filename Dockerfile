# gearbench in a container: `docker build -t gearbench --build-arg GEARBENCH_COMMIT="$(git rev-parse --short=12 HEAD)" .`, then
# `docker run --rm -v "$PWD:/work" gearbench compare spur_impact --out out`.
FROM rust:1-slim-bookworm AS build
WORKDIR /gearbench
COPY . .
# The commit in records: the copy of the sources has no history.
ARG GEARBENCH_COMMIT=unknown
RUN .ci/release.sh program

FROM debian:bookworm-slim
COPY --from=build /gearbench/target/releases/gearbench-*-linux/ /usr/local/
WORKDIR /work
ENTRYPOINT ["gearbench"]
