# Completion for bash of pbrt, lightlab and imgtool. Flags and commands come from the programs' --help, so
# they are those of the program that is installed.

_pbrt_octree() {
  local program=$1 word=$2 previous=$3 command=()
  COMPREPLY=()
  # imgtool's and lightlab's commands have flags of their own.
  case ${program##*/} in
  imgtool) [ "$COMP_CWORD" -gt 1 ] && command=("${COMP_WORDS[1]}") ;;
  lightlab) [ "${COMP_WORDS[1]}" = inspect ] && [ "$COMP_CWORD" -gt 1 ] && command=(inspect) ;;
  esac
  case $previous in
  --lightsampler | --sampler)
    mapfile -t COMPREPLY < <(compgen -W "$(pbrt --list lightsamplers 2> /dev/null | grep -E '^[a-z]+$')" -- "$word")
    return ;;
  --aov)
    mapfile -t COMPREPLY < <(compgen -W "$("$program" --help 2> /dev/null |
      sed -n 's/.*--aov.*{\([a-z,]*\)}.*/\1/p' | tr , ' ')" -- "$word")
    return ;;
  --list)
    mapfile -t COMPREPLY < <(compgen -W "cameras films filters samplers integrators accelerators shapes materials
      floattextures spectrumtextures lights arealights media lightsamplers all table" -- "$word")
    return ;;
  esac
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$("$program" "${command[@]}" --help 2> /dev/null |
      grep -oE -- '^ +(-[a-z],)?--[a-zA-Z][a-zA-Z-]*' | grep -oE -- '--[a-zA-Z-]+' | sort -u)" -- "$word")
    return
  fi
  if [ "${program##*/}" = imgtool ] && [ "$COMP_CWORD" -eq 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W "$("$program" --help 2> /dev/null |
      sed -n '/^Subcommands:/,/^$/s/^  \([a-z]*\) .*/\1/p')" -- "$word")
    return
  fi
  compopt -o filenames 2> /dev/null
  mapfile -t COMPREPLY < <(compgen -f -- "$word")
}
complete -F _pbrt_octree pbrt lightlab imgtool
