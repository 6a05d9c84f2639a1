#!/usr/bin/env bash
# Installs what leviosim needs and is missing, from Debian 12's packages. Does nothing, and needs no
# network, where everything is there.
#   tools/setup.sh          what the program needs
#   tools/setup.sh pages    and what compiles the engine of interactive pages
#   tools/setup.sh tests    what its tests need, too: a browser for pages, references, benchmarks
#   tools/setup.sh full     and other compilers, with their sanitizers and for WebAssembly, and what counts instructions
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source tools/progress.sh

packages=(
  g++ cmake ninja-build git                # compiler, build, revision
  libeigen3-dev libfmt-dev                 # linear algebra, text
  libpng-dev libjpeg62-turbo-dev           # PNG and JPEG files
  libopencv-imgproc-dev                    # OpenCV's core and imgproc, without codecs
  libyaml-dev nlohmann-json3-dev libcli11-dev libssl-dev  # files, command line, SHA-256
  libzstd-dev zlib1g-dev                                      # compressed work traces, CRC-32
  libjs-chart.js                                              # charts of reports, embedded
)
tests=(
  libgtest-dev libexpat1-dev libxml2-utils libspng-dev        # files that are well formed, references
  libopencv-imgcodecs-dev libopencv-calib3d-dev libopencv-features2d-dev
  parallel                                                    # an example of sweeps
  chromium                                                    # pages (120 MB, half a minute)
  libbenchmark-dev libsystemc-dev                             # benchmarks and their yardstick
  python3-dev pybind11-dev python3-numpy                      # the Python module (preset python)
  python3-pil                                                 # pictures, for tools/research
)
pages=(clang lld wasi-libc libc++-14-dev-wasm32 libclang-rt-14-dev-wasm32)  # the engine of interactive pages
compilers=("${pages[@]}" libclang-rt-14-dev clang-tools  # tools/check_reproducible.sh; libFuzzer (tools/fuzz.sh); check_counting.py
  valgrind)                                              # tools/ci/host_work.sh
case ${1:-program} in
  program) ;;
  pages) packages+=("${pages[@]}") ;;
  tests) packages+=("${tests[@]}") ;;
  full) packages+=("${tests[@]}" "${compilers[@]}") ;;
  *)
    echo "setup: unknown set '$1'; expected program, pages, tests or full" >&2
    exit 2
    ;;
esac

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
mkdir -p build
log=build/setup.log
fail() {
  grep -E '^(E|W):' "$log" >&2 || tail -n 10 "$log" >&2
  echo "setup: failed; all that was printed is in $log" >&2
  exit 1
}
echo "setup: installing ${#missing[@]} packages and what they need; $log"
started=$SECONDS
"${as_root[@]}" apt-get update -qq >"$log" 2>&1 || fail
# apt reports "dlstatus:FILE:PERCENT:…" and "pmstatus:PACKAGE:PERCENT:…", each from 0 to 100.
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive LC_ALL=C apt-get install -y -q --no-install-recommends \
  -o APT::Status-Fd=1 "${missing[@]}" 2>&1 </dev/null | tee -a "$log" |
  awk -F: '/^dlstatus:/ { print int($3), 200; fflush() } /^pmstatus:/ { print 100 + int($(NF - 1)), 200; fflush() }' |
  progress "setup" || fail
echo "setup: done in $((SECONDS - started)) s"
