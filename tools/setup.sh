#!/usr/bin/env bash
# Installs what leviosim needs and is missing, from Debian 12's packages. Does nothing, and needs no
# network, where everything is there.
set -euo pipefail

packages=(
  g++ clang cmake ninja-build git          # compilers (Clang for tools/check_reproducible.sh), build
  libclang-rt-14-dev                       # libFuzzer and its sanitizers (tools/fuzz.sh)
  libeigen3-dev libopencv-dev libfmt-dev   # linear algebra, images, text
  libpng-dev libturbojpeg0-dev             # PNG and JPEG files
  libyaml-dev nlohmann-json3-dev libcli11-dev libssl-dev  # files, command line, SHA-256
  libzstd-dev zlib1g-dev                                      # compressed work traces, CRC-32
  libsqlite3-dev                                              # results of sweeps
  parallel                                                    # an example of sweeps, tested
  libjs-chart.js                                              # charts of reports, embedded
  libgtest-dev libexpat1-dev libxml2-utils libspng-dev        # tests
  chromium                                                    # tests of pages (120 MB, half a minute)
  libbenchmark-dev libsystemc-dev                             # benchmarks and their yardstick
)

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  echo "setup: all packages are installed"
  exit 0
fi

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    echo "setup: please install as root: apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "setup: installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
