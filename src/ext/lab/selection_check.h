#pragma once
#include <optional>

#include "ext/lab/selection_verdict.h"
#include "ext/lab/selection_vertices.h"

namespace pbrt::lab {

/// Settings of the check whether a light sampler loses or adds light at the vertices of this scene's paths. A bias is
/// harder to see in pictures, because these have the noise of the paths as well. selection_check.cpp explains the
/// method.
struct SelectionSettings {
    BiasSettings bias;      ///< the check ends when a bias of size `interest` would be seen in half of the regions
    double mostWork = 1e8;  ///< no further round draws more lights than this (0.05 to 1 us each)
    int seed = 0;
};

/// `lights` must be prepared. The result does not depend on the number of
/// threads. Nothing: cancelled.
std::optional<SelectionReport> CheckSelection(const SelectionVertices &vertices, const LightSampler &lights,
                                              const SelectionSettings &settings, Progress &progress);

}  // namespace pbrt::lab
