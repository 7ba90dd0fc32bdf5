#pragma once
#include <functional>

#include "pbrt/integrators/integrator.h"

namespace pbrt {

/// The chunks of a pass, which threads and processes render in any order.
struct PassChunks {
    int64_t count = 0;
    bool splat = false;  ///< samples add splats to the film, for one path each
    std::function<uint32_t(int64_t chunk)> samplesOf;
    /// Renders a chunk of which so many samples are done; returns how many are then: all, unless cancelled.
    std::function<uint32_t(int64_t chunk, uint32_t done)> render;
};

/// Renders what RenderPass::done does not name as done, and keeps account of it there. Returns whether the pass is
/// whole, in all processes that take part.
bool RenderChunks(const RenderPass &pass, const PassChunks &chunks);

}  // namespace pbrt
