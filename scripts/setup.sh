# shellcheck shell=bash
# Installs what the project needs from Debian 12 and builds it. Sourced by scripts/demo and scripts/test.
repo="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"

base_packages=(
  build-essential cmake ninja-build ccache mold pkg-config git ca-certificates
  libzmq3-dev cppzmq-dev libsodium-dev libmd-dev libmsgpack-cxx-dev nlohmann-json3-dev libsqlite3-dev libspdlog-dev libmodbus-dev doctest-dev
  libsdbus-c++-dev libudev-dev libsystemd-dev libjpeg62-turbo-dev libboost-dev libssl-dev libpqxx-dev zlib1g-dev dbus
  python3 procps
)

# ROS 1 as Debian has it: without these the build leaves the ros mode out, and says so.
ros_packages=(
  libroscpp-dev libtopic-tools-dev libnav-msgs-dev libsensor-msgs-dev python3-rosmaster
  ros-actionlib-msgs ros-geometry-msgs ros-std-msgs
)

# What this was tried on; another system may do, and its user should know where to look if it does not.
tried_on='Debian 12 (bookworm)'
this_system="$(. /etc/os-release 2>/dev/null && echo "${PRETTY_NAME:-an unknown system}" || echo 'an unknown system')"
is_tried_on() { (. /etc/os-release 2>/dev/null && [ "${ID:-}" = debian ] && [ "${VERSION_ID:-}" = 12 ]); }
is_tried_on || echo "== this is $this_system; all this was tried on $tried_on alone. It goes on with what is here." >&2

not_installed() {
  cat >&2 <<END
== $1
   This is $this_system, and it was tried on $tried_on alone. What it needs, by Debian's names:
   ${base_packages[*]} ${ros_packages[*]}
   Install these by hand and try again, or use a $tried_on, in a container or a virtual machine.
END
  return 1
}

install_packages() {
  local missing=()
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    is_tried_on || { echo "== without dpkg-query and apt-get nothing is looked for or installed: $*" >&2; return 0; }
    not_installed "there is no dpkg-query or no apt-get"
  fi
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  echo "== installing from Debian: ${missing[*]}"
  local as_root=()
  [ "$(id -u)" -eq 0 ] || as_root=(sudo)
  export DEBIAN_FRONTEND=noninteractive
  local tried="${as_root[*]} apt-get update, then apt-get install ${missing[*]}"
  if ! { "${as_root[@]}" apt-get update -qq &&
    "${as_root[@]}" apt-get install -y -qq --no-install-recommends --no-remove "${missing[@]}" >/dev/null; }; then
    not_installed "tried, and failed: $tried"
  fi
}

# Debian's udev begins to run as it is installed, unless a policy forbids it: the tests run their own, in a namespace.
install_udev() {
  local policy=/usr/sbin/policy-rc.d
  if [ -x /lib/systemd/systemd-udevd ] || [ -e "$policy" ] || [ -d /run/systemd/system ]; then
    install_packages udev
    return
  fi
  local as_root=()
  [ "$(id -u)" -eq 0 ] || as_root=(sudo)
  printf '#!/bin/sh\nexit 101\n' | "${as_root[@]}" tee "$policy" >/dev/null
  "${as_root[@]}" chmod 755 "$policy"
  install_packages udev || { "${as_root[@]}" rm -f "$policy"; return 1; }
  "${as_root[@]}" rm -f "$policy"
}

# changed_files PATTERN...: what differs from the main branch's last commit, committed or not, and what git does not know yet;
# one a line, from the repository's root. All that git knows, if there is no main branch.
changed_files() {
  local base
  if base="$(git -C "$repo" merge-base HEAD main 2>/dev/null)"; then
    { git -C "$repo" diff --name-only --diff-filter=d "$base" -- "$@"
      git -C "$repo" ls-files --others --exclude-standard -- "$@"; } | sort -u
  else
    git -C "$repo" ls-files -- "$@"
  fi
}

# build PRESET TARGET...: configures and builds below build/PRESET
build() {
  local preset="$1"
  shift
  echo "== building ($preset)"
  mkdir -p "$repo/build"
  if ! (cd "$repo" && cmake --preset "$preset") >"$repo/build/configure-$preset.log" 2>&1; then
    cat "$repo/build/configure-$preset.log"
    return 1
  fi
  (cd "$repo" && cmake --build --preset "$preset" -j "$(nproc)" ${1:+--target "$@"})
}
