# Minimal Debian roots, for scripts/fresh and scripts/package, which source this file. They set: suite, base (the folder of the root), logs
# (of debootstrap), cuda (a folder that is lent to the root, or empty).

# The address of Debian's main archive among the sources of apt.
mirror() {
  apt-get indextargets --format '$(SITE) $(CODENAME)' 'Created-By: Packages' 2>/dev/null | sed -n 's/ bookworm$//p' | head -n 1
}

make_base() {
  local from
  from=$(mirror)
  if [[ -z $from ]]; then
    echo "minimal root: no source of apt on this machine has bookworm: fill /etc/apt/sources.list.d, then apt-get update" >&2
    exit 1
  fi
  command -v debootstrap >/dev/null || return 1
  rm -rf "$base.part"
  debootstrap --variant=minbase "$suite" "$base.part" "$from" >"$logs/debootstrap.log" 2>&1 || {
    tail -n 5 "$logs/debootstrap.log" >&2
    exit 1
  }
  rm -rf "$base"
  mv "$base.part" "$base"
}

# What this machine needs to reach its packages, no more: Debian's own sources and their keys, names, certificates, proxies.
configure() {  # ROOT
  local name
  rm -f "$1/etc/apt/sources.list"
  for name in $(grep -lsF "$(mirror)" /etc/apt/sources.list /etc/apt/sources.list.d/*.{list,sources}) \
    $(grep -ls "^Acquire.*Proxy" /etc/apt/apt.conf /etc/apt/apt.conf.d/*) /etc/apt/trusted.gpg.d /etc/apt/keyrings /usr/share/keyrings \
    /etc/resolv.conf /etc/hosts /etc/pip.conf /usr/local/share/ca-certificates; do
    [[ ! -e $name ]] || cp -rL --parents "$name" "$1"
  done
}

# Settings by which pip reaches its index on this machine, for the environment inside.
pip_settings() { env | grep -E '^(PIP_(INDEX_URL|EXTRA_INDEX_URL|CERT|TRUSTED_HOST|DEFAULT_TIMEOUT)|https?_proxy|no_proxy|HTTPS?_PROXY|NO_PROXY)=' || true; }

# inside ROOT USER COMMAND: in a separate mount namespace, so that nothing stays mounted.
inside() {
  local root=$1 user=$2 home=/root settings
  [[ $user == root ]] || home=/home/$user
  mapfile -t settings < <(pip_settings)
  [[ -z $cuda ]] || mkdir -p "$root/usr/local/cuda"
  unshare --mount --propagation private bash -c '
    root=$1 user=$2 cuda=$3
    shift 3
    mount --rbind /dev "$root/dev" && mount -t proc proc "$root/proc" && mount --rbind /sys "$root/sys" || exit 1
    [[ -z $cuda ]] || mount --bind -o ro "$cuda" "$root/usr/local/cuda" || exit 1
    exec chroot --userspec="$user:$user" "$root" env -i "$@"' - "$root" "$user" "$cuda" \
    HOME="$home" USER="$user" LANG=C.UTF-8 TERM="${TERM:-dumb}" CCACHE_DISABLE=1 \
    PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "${settings[@]}" bash -c "$3"
}
