#!/bin/sh
# try_package.sh DEB: installs the Debian package of `make package` on a Debian bookworm that has neither gladstone nor a
# compiler, uses it, removes it, and checks that nothing of it remains. Needs root and the Debian archive.
set -eu
package=$(realpath "$1")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export DEBIAN_FRONTEND=noninteractive
apt-get install -y -q --no-install-recommends "$package" > install.log
dpkg -L gladstone > files.txt

gladstone validate --quiet > validate.txt
gladstone init bos -o bos.toml
gladstone render bos.toml -o case --quiet --set camera.pixels="[96, 96]"
gladstone correlate case --quiet
gladstone info image case/reference.tif --quiet > image.txt
gladstone render bos.toml --preview -o preview.png --quiet
gladstone info image preview.png --quiet > preview.txt      # by the image codecs
gladstone completion bash | cmp - /usr/share/bash-completion/completions/gladstone
gladstone completion zsh | cmp - /usr/share/zsh/vendor-completions/_gladstone
gladstone completion fish | cmp - /usr/share/fish/vendor_completions.d/gladstone.fish
# systems without manual pages remove them when they install a package (dpkg's path-exclude)
grep -qx /usr/share/man/man1/gladstone.1 files.txt

apt-get purge -y -q gladstone > purge.log
while read -r path; do
  if [ -d "$path" ] && dpkg -S "$path" > /dev/null 2>&1; then continue; fi      # a folder of other packages
  if [ -e "$path" ]; then echo "try_package: $path remains" >&2; exit 1; fi
done < files.txt
if find /etc /usr /opt /var -name '*gladstone*' | grep .; then echo "try_package: these files remain" >&2; exit 1; fi
echo "$(basename "$package"): installed, used and removed; it had $(wc -l < files.txt) files and folders"
