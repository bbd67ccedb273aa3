#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Usage: tests/emulate.sh FOLDER PROGRAM [ARGUMENT...]
# Runs a program on an emulated processor with AVX-512, whatever this machine has: the emulator Bochs boots Debian's kernel with the program,
# its libraries and tests/data. Prints what the program prints, and succeeds if it does. Some hundred times slower than the program here. Needs
# section [avx512] of packages.txt; FOLDER gets Debian's kernel, which is not installed.
set -euo pipefail
if [ $# -lt 2 ]; then
    echo "usage: emulate.sh FOLDER PROGRAM [ARGUMENT...]" >&2
    exit 1
fi
source="$(cd "$(dirname "$0")/.." && pwd)"
mkdir -p "$1"
folder="$(cd "$1" && pwd)"
program="$(realpath "$2")"
shift 2

fetch_kernel() {
    local package
    package="$(apt-cache depends linux-image-cloud-amd64 | sed -n 's/ *Depends: *\(linux-image-.*\)/\1/p')"
    (cd "$folder" && apt-get -q download "$package" && dpkg-deb -x "$package"_*.deb kernel && rm "$package"_*.deb)
}
[ -e "$folder/kernel" ] || fetch_kernel

# The first programs of the emulated machine, in memory.
root="$folder/root" disc="$folder/disc"
rm -rf "$root" "$disc" && mkdir -p "$root"/{bin,dev,proc,tmp} "$disc"
cp /bin/busybox "$root/bin/"
libraries="$(ldd "$program" | grep -o '/[^ ]*' || true)" # a static program has none
for library in $libraries; do cp --parents -L "$library" "$root"; done
cp --parents -L "$program" "$root"
cp -r --parents "$source/tests/data" "$root"
cat >"$root/init" <<END
#!/bin/busybox sh
/bin/busybox mount -t proc proc /proc
/bin/busybox mount -t devtmpfs dev /dev
exec >/dev/ttyS0 2>&1
/bin/busybox grep -q avx512vl /proc/cpuinfo || echo "there is no AVX-512"
$(printf '%q ' "$program" "$@")
echo "exit status \$?"
/bin/busybox dmesg | /bin/busybox grep trap
/bin/busybox sleep 1
/bin/busybox poweroff -f
END
chmod +x "$root/init"
(cd "$root" && find . | cpio -o -H newc --quiet | gzip -1) >"$folder/initrd.gz"

# A disc that boots it. For the space that vectors are saved in, compactly, Bochs 2.7 names another size than the kernel expects, which
# would then use no vectors: hence without XSAVEC and XSAVES (321 and 323).
mkdir "$disc/isolinux"
cp "$folder"/kernel/boot/vmlinuz-* "$disc/vmlinuz"
mv "$folder/initrd.gz" "$disc"
cp /usr/lib/ISOLINUX/isolinux.bin /usr/lib/syslinux/modules/bios/ldlinux.c32 "$disc/isolinux/"
cat >"$disc/isolinux/isolinux.cfg" <<END
default program
label program
  kernel /vmlinuz
  append initrd=/initrd.gz console=ttyS0 quiet loglevel=0 mitigations=off clearcpuid=321,323 tsc=reliable
END
genisoimage -quiet -R -o "$folder/disc.iso" -b isolinux/isolinux.bin -c isolinux/boot.cat -no-emul-boot -boot-load-size 4 \
    -boot-info-table "$disc"

cat >"$folder/bochsrc" <<END
cpu: model=corei7_skylake_x, ips=50000000, ignore_bad_msrs=1
megs: 2048
romimage: file=/usr/share/bochs/BIOS-bochs-latest
vgaromimage: file=/usr/share/seabios/vgabios-stdvga.bin
ata0-master: type=cdrom, path=$folder/disc.iso, status=inserted
boot: cdrom
com1: enabled=1, mode=file, dev=$folder/printed.txt
display_library: term
log: $folder/bochs.txt
END
echo continue >"$folder/commands"
rm -f "$folder"/{printed,screen}.txt
# It ends with an error whenever the machine turns itself off, and draws that one's screen on a terminal of its own, which has to be read.
TERM=xterm bochs -f "$folder/bochsrc" -rc "$folder/commands" >"$folder/screen.txt" 2>&1 </dev/null &
emulator=$!
trap 'kill $emulator 2>/dev/null || true' EXIT
screen=""
while [ -z "$screen" ] && kill -0 $emulator 2>/dev/null; do
    sleep 1
    screen="$(sed -n 's/.*connected to screen "\([^"]*\)".*/\1/p' "$folder/screen.txt")"
done
[ -z "$screen" ] || cat "$screen" >/dev/null 2>&1 &
wait $emulator || true
tr -d '\r' <"$folder/printed.txt"
! grep -q "there is no AVX-512" "$folder/printed.txt" && grep -q "^exit status 0" "$folder/printed.txt"
