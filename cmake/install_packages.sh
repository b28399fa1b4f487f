#!/bin/sh
# install_packages.sh [--optional] PACKAGE...
# Prints and installs the missing ones of these Debian packages. Without apt, or without the right to use it, the script
# prints what is required and succeeds: CMake then finds the libraries elsewhere or reports the first missing one.
# --optional: programs that only some tests call. The script then asks for no password, starts no services and reports
# a failure without failing itself; those tests are skipped.
set -eu

optional=
[ "${1:-}" != --optional ] || { optional=yes && shift; }

if ! command -v dpkg-query >/dev/null 2>&1 || ! command -v apt-get >/dev/null 2>&1; then
  echo "gladstone: no apt on this system; install these packages${optional:+ for some tests} (Debian's names): $*" >&2
  exit 0
fi

missing=
for package in "$@"; do
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

as_root=
if [ "$(id -u)" -ne 0 ]; then
  as_root="sudo${optional:+ -n}"
  if ! command -v sudo >/dev/null 2>&1 || { [ -n "$optional" ] && ! $as_root true 2>/dev/null; }; then
    echo "gladstone: packages${optional:+ of some tests} are missing and cannot be installed without root or sudo:$missing" >&2
    exit 0
  fi
fi

apt() { $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -o Acquire::Retries=3 "$@" </dev/null; }
# shellcheck disable=SC2086  # split the list into words
install() { apt install -y --no-install-recommends $missing; }

echo "gladstone: installing Debian packages:$missing" >&2
# Without package lists (a bare system), or with lists so old that their files no longer exist, update them first.
# shellcheck disable=SC2086
lists() { apt-get install -s -qq --no-install-recommends $missing >/dev/null 2>&1 || apt update; }

if [ -z "$optional" ]; then
  lists
  install || { apt update && install; } || {
    echo "gladstone: cannot install these packages:$missing" >&2
    exit 1
  }
  exit 0
fi

# Debian's packages start their services only if this file, if it exists, permits it.
policy=/usr/sbin/policy-rc.d
if [ ! -e $policy ]; then
  trap '$as_root rm -f $policy' EXIT
  trap 'exit 1' HUP INT TERM
  printf '#!/bin/sh\nexit 101\n' | $as_root tee $policy >/dev/null
  $as_root chmod 755 $policy
fi
{ lists && install; } || { apt update && install; } ||
  echo "gladstone: not installed; the tests that need these packages are skipped:$missing" >&2
