#pragma once
#include <vector>

#include "pbrt/build/built_scene.h"
#include "pbrt/bxdfs/bsdf.h"

namespace pbrt::lab {

/// The vertices that receive light, of paths through sixteen regions of the picture, with the contribution of every
/// light. They do not depend on the number of threads.
class SelectionVertices {
  public:
    struct MeasuredLight {
        uint32_t light = 0;
        Float c = 0;               ///< contribution by one point on the light, times the path's weight; above 0
        Float pdf = 0, pBsdf = 0;  ///< densities of that point and of BSDF sampling, per solid angle
        bool isDelta = false, isInfinite = false;
        Point3 pLight{};
        Vector3 wi{};  ///< unit, towards the point
    };
    struct Vertex {
        LightQuery query;  ///< without BSDF and wavelengths, which are below
        Bsdf bsdf;
        SampledWavelengths lambda;
        std::vector<MeasuredLight> lights;
        bool endsPath = false;
    };
    /// Incomplete if cancelled.
    SelectionVertices(const BuiltScene &built, int seed, Progress &progress);
    const std::vector<Vertex> &OfRegion(size_t region) const { return regions_[region]; }
    size_t RegionCount() const { return regions_.size(); }
    const LightTable &Lights() const { return lights_; }
    size_t VertexCount() const;

  private:
    std::vector<std::vector<Vertex>> regions_;
    const LightTable &lights_;
};

}  // namespace pbrt::lab
