#include "pbrt/images/image_library.h"

#include <dlfcn.h>

#include "pbrt/core/error.h"

namespace pbrt::oiio {
namespace {

const ImageLibrary &Load() {
    // Found by the programs' run path. Never unloaded, because images may use it until exit.
    void *module = dlopen(PBRT_OIIO_MODULE, RTLD_NOW | RTLD_LOCAL);
    void *entry = module ? dlsym(module, "PbrtImageLibrary") : nullptr;
    if (!entry) throw UserError("{} cannot be loaded: {}.", PBRT_OIIO_MODULE, dlerror());
    return *reinterpret_cast<const ImageLibrary *(*)()>(entry)();
}

}  // namespace

const ImageLibrary &Library() {
    static const ImageLibrary &library = Load();
    return library;
}

}  // namespace pbrt::oiio
