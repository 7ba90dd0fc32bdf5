#pragma once
#include <vector>

#include "pbrt/build/built_scene.h"
#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/bxdfs/henyey_greenstein.h"

namespace pbrt::lab {

/// The vertices that receive light, on surfaces and in media, of paths through sixteen regions of the picture, with the
/// contribution of every light. They do not depend on the number of threads.
class SelectionVertices {
  public:
    struct MeasuredLight {
        uint32_t light = 0;
        Float c = 0;               ///< contribution by one point on the light, times the path's weight; above 0
        Float pdf = 0, pBsdf = 0;  ///< densities of that point and of scattering towards it, per solid angle
        bool isDelta = false, isInfinite = false;
        Vector3 wi{};  ///< unit, towards the point
    };
    struct Vertex {
        LightQuery query;        ///< without the pointers to what scatters and to the wavelengths, which are below
        Bsdf bsdf;               ///< on a surface
        HenyeyGreenstein phase;  ///< in a medium
        SampledWavelengths lambda;
        std::vector<MeasuredLight> lights;
        bool endsPath = false;

        bool IsInMedium() const { return query.ns == Normal3(0); }
        /// The query as the render asks it. Refers to this vertex.
        LightQuery FullQuery() const {
            LightQuery full = query;
            full.lambda = &lambda;
            if (IsInMedium())
                full.phase = &phase;
            else
                full.bsdf = &bsdf;
            return full;
        }
    };
    /// Incomplete if cancelled.
    SelectionVertices(const BuiltScene &built, int seed, Progress &progress);
    const std::vector<Vertex> &OfRegion(size_t region) const { return regions_[region]; }
    size_t RegionCount() const { return regions_.size(); }
    int PathsPerRegion() const { return paths_; }
    const LightTable &Lights() const { return lights_; }
    size_t VertexCount() const;

  private:
    std::vector<std::vector<Vertex>> regions_;
    int paths_ = 0;
    const LightTable &lights_;
};

}  // namespace pbrt::lab
