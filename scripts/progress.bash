# Sourced by the other scripts: progress of long work as one line that moves on a terminal, and elsewhere as a line at
# every tenth.

progress_label= progress_since=0 progress_tenth=-1

# progress_begin LABEL
progress_begin() { progress_label=$1 progress_since=$SECONDS progress_tenth=-1; }

# minutes SECONDS: as 3:07
minutes() { printf '%d:%02d' $(($1 / 60)) $(($1 % 60)); }

# progress PERCENT [DETAIL]: PERCENT is a whole number
progress() {
  local passed=$((SECONDS - progress_since)) line
  line="$progress_label $1 %, $(minutes "$passed")"
  if (($1 >= 10 && $1 < 100)); then line+=", about $(minutes $((passed * (100 - $1) / $1))) left"; fi
  [[ -z ${2:-} ]] || line+="  $2"
  if [[ -t 2 ]]; then
    printf '\r\e[K%.79s' "$line" >&2
  elif (($1 / 10 > progress_tenth)); then
    progress_tenth=$(($1 / 10))
    echo "$line" >&2
  fi
}

# progress_end [TEXT]: takes the line away; TEXT, followed by the time, stays
progress_end() {
  [[ ! -t 2 ]] || printf '\r\e[K' >&2
  [[ -z ${1:-} ]] || echo "$1 in $(minutes $((SECONDS - progress_since)))" >&2
}

# ninja_progress: shows the steps of ninja on stdin as progress and passes on what else it prints
ninja_progress() {
  local line step=0 steps=0
  progress_begin "build:"
  while IFS= read -r line; do
    if [[ $line =~ ^\[([0-9]+)/([0-9]+)\]\ (Re-checking|Re-running|Building|Linking|Running|Generating|Automatic) ]]; then
      [[ ${BASH_REMATCH[3]} == Re-* ]] && continue
      step=${BASH_REMATCH[1]} steps=${BASH_REMATCH[2]}
      progress $((100 * step / steps)) "step $step of $steps"
    elif [[ $line != "ninja: no work to do." ]]; then
      progress_end
      printf '%s\n' "$line" >&2
    fi
  done
  if ((steps == 0 || step < steps)); then progress_end; else progress_end "build: $steps steps"; fi
}

# with_clock LABEL COMMAND...: for work that does not say how far it is; its output appears if it fails
with_clock() {
  local label=$1 output status=0 worker
  shift
  output=$(mktemp)
  progress_begin "$label"
  set -m  # a process group of its own
  "$@" >"$output" 2>&1 </dev/null &
  set +m
  worker=$!
  trap 'kill -- -"$worker" 2>/dev/null; rm -f "$output"; exit 130' INT TERM  # a job in the background ignores Ctrl-C
  [[ -t 2 ]] || echo "$label" >&2
  while [[ -t 2 ]] && kill -0 "$worker" 2>/dev/null; do
    printf '\r\e[K%s %s' "$label" "$(minutes $((SECONDS - progress_since)))" >&2
    sleep 1
  done
  wait "$worker" || status=$?
  trap - INT TERM
  progress_end
  ((status == 0)) || cat "$output" >&2
  rm -f "$output"
  return "$status"
}
