#!/bin/sh
# Installs what the tests need (once) and runs them all. Extra arguments go to `cargo test`.
set -eu
cd "$(dirname "$0")/.."

as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

# A software Vulkan driver and its loader: the GPU suite fails without an adapter.
packages=""
ls /usr/share/vulkan/icd.d/lvp_icd*.json >/dev/null 2>&1 || packages="$packages mesa-vulkan-drivers"
ls /usr/lib/*/libvulkan.so.1 >/dev/null 2>&1 || packages="$packages libvulkan1"
# The second software driver comes with an npm package.
if [ ! -e target/swiftshader/libvk_swiftshader.so ]; then
    command -v npm >/dev/null 2>&1 || packages="$packages nodejs npm"
fi
if [ -n "$packages" ]; then
    echo "installing:$packages"
    as_root apt-get update -qq
    # shellcheck disable=SC2086 # a list of words is meant
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $packages
fi
sh tests/swiftshader.sh

# A Mesa layer looks for a desktop session and complains where there is none.
export NODEVICE_SELECT=1
exec cargo test --workspace --locked "$@"
