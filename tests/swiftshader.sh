#!/bin/sh
# Puts SwiftShader, a Vulkan driver that runs on the CPU, into a folder: target/swiftshader, or the one that is named.
# crates/cli/tests/drivers.rs holds it to the bytes of the other backends. Does nothing where it is already there.
# For Linux on x86-64; elsewhere name a folder with another build in SURFINE_SWIFTSHADER.
set -eu

version=147.0.0
# Of the library, so that nothing else is ever loaded: change it with the version.
sha256=5b9e8591c7c2d1c9618c3ad485d0cdffb81f5f1ffd6a982fdb6578c2d8d3213e
folder=${1:-$(dirname "$0")/../target/swiftshader}
library=libvk_swiftshader.so
manifest=vk_swiftshader_icd.json

if [ -s "$folder/$library" ] && [ -s "$folder/$manifest" ]; then
    echo "SwiftShader is in $folder"
    exit
fi
for tool in node npm; do
    command -v "$tool" >/dev/null || {
        echo "SwiftShader needs $tool: apt-get install nodejs npm" >&2
        exit 1
    }
done

mkdir -p "$folder"
scratch=$(mktemp -d "$folder.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
# The npm package of a headless browser: few places offer the driver ready-made.
npm pack --silent --pack-destination "$scratch" "@sparticuz/chromium@$version" >/dev/null
tar -xzf "$scratch"/*.tgz -C "$scratch" package/bin/swiftshader.tar.br
# tar knows no brotli.
node -e 'process.stdout.write(zlib.brotliDecompressSync(fs.readFileSync(process.argv[1])))' \
    "$scratch/package/bin/swiftshader.tar.br" >"$scratch/swiftshader.tar"
tar -xof "$scratch/swiftshader.tar" -C "$scratch"
echo "$sha256  $scratch/$library" | sha256sum -c --status || {
    echo "SwiftShader $version is not the expected file" >&2
    exit 1
}
# The manifest names the library relative to itself, so both go together and the manifest last.
mv "$scratch/$library" "$folder/$library"
mv "$scratch/$manifest" "$folder/$manifest"
echo "SwiftShader $version is in $folder"
