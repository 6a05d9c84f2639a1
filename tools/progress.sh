# For scripts: shows how far something is, on one line that changes in a terminal, else in at most ten lines.
#   … | progress LABEL      reads lines "DONE TOTAL", as they come
progress() {
  local label=$1 done total tenth shown=0
  while read -r done total; do
    ((total > 0)) || continue
    if [[ -t 2 ]]; then
      printf '\r%s: %3d %%' "$label" $((100 * done / total)) >&2
    elif tenth=$((10 * done / total)) && ((tenth > shown)); then
      shown=$tenth
      printf '%s: %d %%\n' "$label" $((10 * tenth)) >&2
    fi
  done
  if [[ -t 2 ]]; then printf '\r\033[K' >&2; fi
}
