#pragma once
#include <optional>

#include "pbrt/lab/selection_verdict.h"
#include "pbrt/lab/selection_vertices.h"

namespace pbrt::lab {

/// Does a light sampler lose or add light at the vertices of this scene's paths? Pictures are a hard place to see that:
/// their noise is that of the paths as well. selection_check.cpp explains the method.
struct SelectionSettings {
    BiasSettings bias;      ///< it ends when a bias of its `interest` would be seen in half of the regions
    double mostWork = 1e8;  ///< lights drawn in the last round, about (0.05 to 1 us each); it ends there too
    int seed = 0;
};

/// `lights`, and `gate` if there is one, are prepared. The same for any number of threads. Nothing: cancelled.
std::optional<SelectionReport> CheckSelection(const SelectionVertices &vertices, const LightSampler &lights,
                                              const ShadowRayGate *gate, const SelectionSettings &settings,
                                              Progress &progress);

}  // namespace pbrt::lab
