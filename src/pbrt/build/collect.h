#pragma once
#include "pbrt/core/error.h"
#include "pbrt/scenefile/scene_description.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

/// Runs `make`, turning its UserError into collected diagnostics. True if it succeeded.
template <class F>
bool Collect(DiagnosticSink &sink, F &&make) {
    try {
        make();
        return true;
    } catch (const UserError &e) {
        sink.Add(e);
        return false;
    }
}

/// The colour space that an entity's colours are given in.
inline const ColorSpace &SpaceOf(const Entity &e) {
    const ColorSpace *space = ColorSpace::Find(e.colorSpace);
    PBRT_CHECK_MSG(space != nullptr, "colour space {}", e.colorSpace);
    return *space;
}

}  // namespace pbrt
