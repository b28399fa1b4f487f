#!/bin/sh
# install_packages.sh PACKAGE...
# Installs those of the Debian packages that are missing, after saying which. Where there is no apt, or no right to use
# it, says what is needed and goes on: CMake then finds the libraries elsewhere or names the first one that it misses.
set -eu

if ! command -v dpkg-query >/dev/null 2>&1 || ! command -v apt-get >/dev/null 2>&1; then
  echo "gladstone: no apt on this system; these must be there (Debian's names): $*" >&2
  exit 0
fi

missing=
for package in "$@"; do
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

as_root=
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null 2>&1; then
    echo "gladstone: missing packages, and neither root nor sudo to install them:$missing" >&2
    exit 0
  fi
  as_root=sudo
fi

apt() { $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -o Acquire::Retries=3 "$@" </dev/null; }
# shellcheck disable=SC2086  # the list is to be split
install() { apt install -y --no-install-recommends $missing; }

echo "gladstone: installing Debian packages:$missing" >&2
# No package lists (a bare system), or lists so old that their files are gone: fetch them, then install.
# shellcheck disable=SC2086
apt-get install -s -qq --no-install-recommends $missing >/dev/null 2>&1 || apt update
install || { apt update && install; } || {
  echo "gladstone: these packages could not be installed:$missing" >&2
  exit 1
}
