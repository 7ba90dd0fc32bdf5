# Writes OUTPUT, the definition of pbrt::VersionText, from VERSION and the commit of the checkout SOURCE, if it changes.
# Run at every build (target pbrt_version_text), as a commit does not configure the build folder again.
execute_process(COMMAND git -C ${SOURCE} rev-parse --show-toplevel OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
get_filename_component(source ${SOURCE} REALPATH)
set(commit "commit unknown")
if(top STREQUAL source) # an unpacked archive may lie within another checkout
  execute_process(COMMAND git -C ${SOURCE} rev-parse --short HEAD OUTPUT_VARIABLE hash OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  execute_process(COMMAND git -C ${SOURCE} status --porcelain --untracked-files=no OUTPUT_VARIABLE changes ERROR_QUIET)
  if(hash)
    set(commit "commit ${hash}")
    if(changes)
      string(APPEND commit ", modified")
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [[
#include "pbrt/core/version.h"

namespace pbrt {
const char *VersionText() { return "pbrt_octree @VERSION@ (@commit@)"; }
}  // namespace pbrt
]] @ONLY)
