#!/usr/bin/env bash
# Builds target/release/lumiduct for others: without a path of this machine in it. Arguments go to `cargo build`.
set -euo pipefail
cd "$(dirname "$0")/.."

# What stands at the head of paths here, and what stands there in the program.
prefixes=("$(pwd -P)=lumiduct" "${CARGO_HOME:-$HOME/.cargo}=cargo" "$(rustc --print sysroot)=rust" "${RUSTUP_HOME:-$HOME/.rustup}=rustup")
flags=${CARGO_ENCODED_RUSTFLAGS:-}
for prefix in "${prefixes[@]}"; do
    flags+="${flags:+$'\x1f'}--remap-path-prefix=$prefix"
done
CARGO_ENCODED_RUSTFLAGS=$flags cargo build --release --locked "$@"

program=${CARGO_TARGET_DIR:-target}/release/lumiduct
for prefix in "${prefixes[@]}" "${HOME%/}/="; do
    if LC_ALL=C grep --quiet --text --fixed-strings "${prefix%=*}" "$program"; then
        echo "error: $program holds the path ${prefix%=*} of this machine" >&2
        exit 1
    fi
done
echo "$program holds no path of this machine"
