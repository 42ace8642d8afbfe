#!/bin/sh
# Builds nodes with zdbsp, then REJECT lumps with sightlines in the file that zdbsp has written.
#
#   zdbsp-reject.sh [options of zdbsp] -oOUT.wad IN.wad
#
# Both programs are looked for beside this script, then in PATH; ZDBSP and SIGHTLINES name others.
# Says nothing but what goes wrong: an editor may take any word for a failure.
set -u

here=$(dirname -- "$0")
find_program() {
    if [ -x "$here/$1" ]; then
        printf '%s\n' "$here/$1"
    else
        printf '%s\n' "$1"
    fi
}
zdbsp=${ZDBSP:-$(find_program zdbsp)}
sightlines=${SIGHTLINES:-$(find_program sightlines)}

# The file that zdbsp writes: -oOUT, -o OUT, --output=OUT or --output OUT; without any of them tmp.wad.
out=tmp.wad
next=
for word in "$@"; do
    if [ -n "$next" ]; then
        out=$word
        next=
        continue
    fi
    case $word in
        -o | --output) next=yes ;;
        -o*) out=${word#-o} ;;
        --output=*) out=${word#--output=} ;;
    esac
done

told=$("$zdbsp" "$@" 2>&1)
code=$?
if [ "$code" -ne 0 ]; then
    printf '%s\nerror: zdbsp ended with code %s\n' "$told" "$code" >&2
    exit 1
fi
"$sightlines" -q reject "$out" -o "$out" --strict >/dev/null || {
    printf 'error: no REJECT lump was built in %s\n' "$out" >&2
    exit 2
}
