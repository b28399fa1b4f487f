#!/bin/sh
# install_packages.sh [--optional] PACKAGE...
# Installs those of the Debian packages that are missing, after saying which. Where there is no apt, or no right to use
# it, says what is needed and goes on: CMake then finds the libraries elsewhere or names the first one that it misses.
# --optional: programs that only some tests call. Nobody is asked for a password, the services among them are not
# started, and a failure is only told: those tests are then skipped.
set -eu

optional=
[ "${1:-}" != --optional ] || { optional=yes && shift; }

if ! command -v dpkg-query >/dev/null 2>&1 || ! command -v apt-get >/dev/null 2>&1; then
  echo "gladstone: no apt on this system; these must be there${optional:+ for some tests} (Debian's names): $*" >&2
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
    echo "gladstone: missing packages${optional:+ of some tests}, and neither root nor sudo to install them:$missing" >&2
    exit 0
  fi
fi

apt() { $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -o Acquire::Retries=3 "$@" </dev/null; }
# shellcheck disable=SC2086  # the list is to be split
install() { apt install -y --no-install-recommends $missing; }

echo "gladstone: installing Debian packages:$missing" >&2
# No package lists (a bare system), or lists so old that their files are gone: fetch them, then install.
# shellcheck disable=SC2086
lists() { apt-get install -s -qq --no-install-recommends $missing >/dev/null 2>&1 || apt update; }

if [ -z "$optional" ]; then
  lists
  install || { apt update && install; } || {
    echo "gladstone: these packages could not be installed:$missing" >&2
    exit 1
  }
  exit 0
fi

# Debian asks this file, if it is there, whether a package may start its service.
policy=/usr/sbin/policy-rc.d
if [ ! -e $policy ]; then
  trap '$as_root rm -f $policy' EXIT
  trap 'exit 1' HUP INT TERM
  printf '#!/bin/sh\nexit 101\n' | $as_root tee $policy >/dev/null
  $as_root chmod 755 $policy
fi
{ lists && install; } || { apt update && install; } ||
  echo "gladstone: not installed, so the tests that need them are skipped:$missing" >&2
