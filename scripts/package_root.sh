# shellcheck shell=bash
# A Debian 12 in a folder. Sourced by scripts/package, scripts/test-package and scripts/test-vm, behind setup.sh.
need_root() {
  [ "$(id -u)" -eq 0 ] && return 0
  echo "scripts/$(basename "$0"): $1 needs root: use sudo" >&2
  return 1
}

# run_by_qemu: this machine runs programs for 64-bit ARM by qemu-user, until the script ends.
run_by_qemu() {
  local formats=/proc/sys/fs/binfmt_misc
  need_root "running programs of another architecture"
  install_packages qemu-user-static
  [ -e "$formats/register" ] || mount -t binfmt_misc none "$formats"
  [ ! -e "$formats/qemu-aarch64" ] || return 0
  cat /usr/lib/binfmt.d/qemu-aarch64.conf >"$formats/register"
  trap 'echo -1 >/proc/sys/fs/binfmt_misc/qemu-aarch64' EXIT
}

# debian_root DIR [ARCH]: made by debootstrap, complete or not there; with this machine's sources of packages.
debian_root() {
  [ -d "$1" ] && return 0
  need_root "a Debian in a folder"
  install_packages debootstrap
  echo "== a bare Debian 12${2:+ for $2} in $1"
  mkdir -p "$(dirname "$1")"
  rm -rf "$1.half"
  debootstrap ${2:+--arch "$2"} --variant=minbase bookworm "$1.half" http://deb.debian.org/debian >"$1.log" 2>&1 || { tail -n 20 "$1.log" >&2; return 1; }
  rm -rf "$1.half/etc/apt" && cp -a /etc/apt "$1.half/etc/apt"
  printf '#!/bin/sh\nexit 101\n' >"$1.half/usr/sbin/policy-rc.d"  # nothing is started in it
  chmod 755 "$1.half/usr/sbin/policy-rc.d"
  mv "$1.half" "$1"
}

# in_root DIR PLACE CCACHE COMMAND...: the command in DIR, where PLACE and CCACHE are, too. All mounts end with it.
in_root() {
  local root="$1" place="$2" cache="$3"
  shift 3
  mkdir -p "$root$place" "$root$cache" "$cache"
  unshare --mount --pid --fork --kill-child bash -c '
    set -e
    root="$0" place="$1" cache="$2"
    shift 2
    mount --make-rprivate /
    mount -t proc proc "$root/proc"
    mount --rbind /dev "$root/dev"
    mount --bind "$place" "$root$place"
    mount --bind "$cache" "$root$cache"
    cp -L /etc/resolv.conf "$root/etc/resolv.conf"
    exec chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive CCACHE_DIR="$cache" "$@"
  ' "$root" "$place" "$cache" "$@"
}

# cross_root DIR ARCH: a Debian with what builds for another architecture; made anew when what is needed has changed. Not on the
# machine itself: libpqxx-dev is there for one architecture at a time. ROS' headers want two packages of the other architecture
# that are there for none but the machine's (libroscpp-msg-dev) or would not run (python3): a package without files stands for
# both, and the machine's own are what is used.
cross_root() {
  local needs
  needs="$(cat "$repo/deploy/debian/control" "$repo/scripts/package_root.sh" | sha256sum)"
  [ "$(cat "$1/ready" 2>/dev/null)" != "$needs" ] || return 0
  debian_root "$work/base-root"
  rm -rf "$1"
  cp -a --reflink=auto "$work/base-root" "$1"
  echo "== installing what builds for $2 in $1 (log: $1.log)"
  in_root "$1" "$repo/deploy" "$cache" bash -ec '
    arch="$0" control="$1/debian/control"
    dpkg --add-architecture "$arch"
    apt-get update -qq
    apt-get install -y -qq --no-install-recommends build-essential "crossbuild-essential-$arch" ccache git qemu-user fakeroot \
      python3 libroscpp-msg-dev
    mkdir -p /tmp/stands-in/DEBIAN /tmp/dep/debian
    printf "%s\n" "Package: talkrobots-cross-stands-in" "Version: 1" "Architecture: $arch" "Maintainer: root <root@localhost>" \
      "Provides: libroscpp-msg-dev, python3" "Description: stands for packages of $arch that nothing needs here" \
      >/tmp/stands-in/DEBIAN/control
    dpkg-deb --build /tmp/stands-in /tmp/stands-in.deb
    dpkg --install /tmp/stands-in.deb
    cp "$control" "$1/debian/changelog" /tmp/dep/debian/
    apt-get build-dep -y -qq --no-install-recommends -a "$arch" -P cross /tmp/dep
  ' "$2" "$repo/deploy" >"$1.log" 2>&1 || { tail -n 20 "$1.log" >&2; return 1; }
  echo "$needs" >"$1/ready"
}
