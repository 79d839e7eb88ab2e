# gearbench in a container: `docker build -t gearbench .`, then
# `docker run --rm -v "$PWD:/work" gearbench compare spur_impact --out out`.
FROM rust:1-slim-bookworm AS build
WORKDIR /gearbench
COPY . .
# The program and the library of FMUs, without the checkout that they were compiled in.
ENV GEARBENCH_RELEASE=1 CARGO_INCREMENTAL=0
RUN cargo build --profile dist --locked --workspace --bin gearbench --lib

FROM debian:bookworm-slim
COPY --from=build /gearbench/target/dist/gearbench /usr/local/bin/
COPY --from=build /gearbench/target/dist/libgearbench_fmu.so /usr/local/lib/
COPY --from=build /gearbench/LICENSE-MIT /gearbench/LICENSE-APACHE /usr/local/share/doc/gearbench/
WORKDIR /work
ENTRYPOINT ["gearbench"]
