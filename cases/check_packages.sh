#!/bin/sh
# Makes sure that the Debian packages of the given list are installed: silent when they are, installs them as root or
# by sudo otherwise, and says plainly which are missing where it may not. PACKAGES=skip passes over all of this.
set -eu
list=$1
[ "${PACKAGES:-check}" = skip ] && exit 0
wanted=$(sed 's/#.*//' "$list" | tr -s ' \t\n' ' ')
if ! command -v dpkg-query >/dev/null; then
  echo "Not a Debian system: the packages of $list are not checked; install their equivalents." >&2
  exit 0
fi
# shellcheck disable=SC2086
installed=$(dpkg-query -W -f='${db:Status-Abbrev}:${Package}\n' $wanted 2>/dev/null | sed -n 's/^ii *://p' || true)
missing=
for package in $wanted; do
  printf '%s\n' "$installed" | grep -qxF "$package" || missing="$missing $package"
done
[ -z "$missing" ] && exit 0

if [ "$(id -u)" = 0 ]; then
  as_root=
elif command -v sudo >/dev/null && { [ -t 0 ] || sudo -n true 2>/dev/null; }; then
  as_root=sudo
else
  {
    echo "These packages are missing and this user may not install them:"
    echo "  $missing"
    echo "Ask an administrator for:  apt-get install --no-install-recommends$missing"
    echo "or go on without them:     make -f Makefile.cases PACKAGES=skip ..."
  } >&2
  exit 1
fi
echo "Installing:$missing"
$as_root apt-get update -qq
# shellcheck disable=SC2086
DEBIAN_FRONTEND=noninteractive $as_root apt-get install -y -qq --no-install-recommends $missing >/dev/null
