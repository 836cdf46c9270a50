# Shared by scripts/demo, scripts/test and .ci/run; to be sourced. Leaves the shell in the
# repository's root.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# ccache entries are independent of the source folder: a second clone compiles nothing.
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1
# required by ccache for precompiled headers
export CCACHE_SLOPPINESS=pch_defines,time_macros

say() { echo "== $*"; }

# Through sudo only the packages need root: what is built belongs to the user who owns the tree.
return_to_the_user() {
  if ((EUID == 0)) && [[ ${SUDO_UID:-0} != 0 && $(stat --format=%u .) == "$SUDO_UID" ]]; then
    exec sudo --set-home --user="#$SUDO_UID" -- "$@"
  fi
}

# configure PRESET [cmake arguments]
configure() {
  say "configuring build/$1"
  CMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER-$(command -v ccache || true)} \
    cmake --preset "$@" --log-level=WARNING >/dev/null
}

# build PRESET [cmake --build arguments]
build() {
  say "building build/$1"
  cmake --build --preset "$@"
}

# changed_sources COUNT: the COUNT existing .cpp files that the latest commits changed.
changed_sources() {
  git log --format= --name-only --diff-filter=d -n 200 -- '*.cpp' | awk '!seen[$0]++' |
    while read -r file; do if [[ -f $file ]]; then echo "$file"; fi; done | head -n "$1" || true
}
