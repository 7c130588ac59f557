# Images of eyesim.
#
#   docker build --target dev -t eyesim-dev .    all that `.ci/run` needs; `docker run -it -v "$PWD:/eyesim" eyesim-dev`
#   docker build -t eyesim .                     the installed wheel; `docker run --rm -v "$PWD:/work" eyesim run maze.sim`

FROM debian:bookworm AS dev
RUN apt-get update -qq && apt-get install -y -qq --no-install-recommends \
        ca-certificates chromium curl fonts-dejavu-core g++ gcc gdb git libc6-dev nodejs npm python3 python3-venv && \
    rm -rf /var/lib/apt/lists/*
ENV PATH=/root/.cargo/bin:$PATH
COPY rust-toolchain.toml /eyesim/
WORKDIR /eyesim
RUN curl --proto =https -sSfo /tmp/rustup-init "https://static.rust-lang.org/rustup/dist/$(uname -m)-unknown-linux-gnu/rustup-init" && \
    chmod +x /tmp/rustup-init && /tmp/rustup-init -y -q --profile minimal --default-toolchain none --no-modify-path && \
    rm /tmp/rustup-init && rustup toolchain install

FROM dev AS wheel
COPY . .
RUN python3 -m venv /tools && /tools/bin/pip install -q 'maturin>=1.9,<2' && PATH=/tools/bin:$PATH python/wheel --quiet --profile dist --out /wheels

FROM debian:bookworm-slim
# A compiler for programs in C and C++, a debugger for `eyesim debug`.
RUN apt-get update -qq && apt-get install -y -qq --no-install-recommends g++ gcc gdb libc6-dev python3 python3-venv && rm -rf /var/lib/apt/lists/*
COPY --from=wheel /wheels /wheels
RUN python3 -m venv /opt/eyesim && /opt/eyesim/bin/pip install -q --no-cache-dir /wheels/*.whl && rm -rf /wheels
ENV PATH=/opt/eyesim/bin:$PATH
WORKDIR /work
ENTRYPOINT ["eyesim"]
