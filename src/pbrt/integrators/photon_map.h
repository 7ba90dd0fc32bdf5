#pragma once
#include <functional>
#include <vector>

#include "pbrt/spectra/spectrum.h"

namespace pbrt {

/// A place where a light path met a surface.
struct Photon {
    Point3 p{};
    Vector3 wi{0, 0, 1};  ///< unit, to where the light came from
    /// Power, per power of one light path, times the ratio of the cosines at the shading normal and at the geometric
    /// normal of the place: a camera path would shade by the former.
    SampledSpectrum power{0};
    int scatterings = 0;       ///< of the light path before this place
    bool isOneColour = false;  ///< only the first wavelength counts, as after SampledWavelengths::TerminateSecondary

    /// The power as a path with these wavelengths, which share the first one with it, counts it.
    SampledSpectrum PowerFor(bool pathIsOneColour) const {
        if (!isOneColour || pathIsOneColour) return power;
        // The density of the first wavelength was divided by their number; here it was not.
        SampledSpectrum first(0);
        first[0] = power[0] * static_cast<Float>(SpectrumSamples);
        return first;
    }
};

/// Photons that can be asked for around a place. They are found in an order that depends on their numbers only.
class PhotonMap {
  public:
    /// Takes over photons, in groups; those are numbered one group after another. Queries have this radius.
    void Build(std::vector<std::vector<Photon>> &groups, Float radius);
    void Clear() { *this = {}; }

    Float Radius() const { return radius_; }
    size_t Size() const { return photons_.size(); }
    /// Calls visit(photon) for every photon that is not farther from `p` than the radius.
    template <class Visit>
    void ForEachAround(const Point3 &p, Visit &&visit) const;

  private:
    struct Cell {
        int64_t x, y, z;
        bool operator==(const Cell &) const = default;
    };
    /// The cells are as wide as the sphere of a query, which so lies in at most eight of them.
    Cell CellOf(double x, double y, double z) const {
        return {static_cast<int64_t>(std::floor(x * perWidth_)), static_cast<int64_t>(std::floor(y * perWidth_)),
                static_cast<int64_t>(std::floor(z * perWidth_))};
    }
    Cell CellOf(const Point3 &p) const { return CellOf(double(p.x), double(p.y), double(p.z)); }
    /// Cells share buckets.
    size_t BucketOf(const Cell &cell) const;

    std::vector<Photon> photons_;   ///< sorted by bucket, inside a bucket by number
    std::vector<uint32_t> begins_;  ///< of each bucket, and the end of the last one; empty without photons
    Float radius_ = 0;
    double perWidth_ = 0;
};

template <class Visit>
void PhotonMap::ForEachAround(const Point3 &p, Visit &&visit) const {
    if (photons_.empty()) return;
    const double r = double(radius_);
    const Cell low = CellOf(double(p.x) - r, double(p.y) - r, double(p.z) - r),
               high = CellOf(double(p.x) + r, double(p.y) + r, double(p.z) + r);
    for (int64_t z = low.z; z <= high.z; ++z)
        for (int64_t y = low.y; y <= high.y; ++y)
            for (int64_t x = low.x; x <= high.x; ++x) {
                const Cell cell{x, y, z};
                const size_t bucket = BucketOf(cell);
                for (uint32_t i = begins_[bucket]; i < begins_[bucket + 1]; ++i) {
                    const Photon &photon = photons_[i];
                    // The bucket may hold photons of other cells, also of those that have a turn of their own.
                    if (LengthSquared(photon.p - p) <= radius_ * radius_ && CellOf(photon.p) == cell) visit(photon);
                }
            }
}

}  // namespace pbrt
