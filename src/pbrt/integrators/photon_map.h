#pragma once
#include <bit>
#include <vector>

#include "pbrt/math/rng.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

/// Intersection of a light path with a surface.
struct Photon {
    Point3 p{};
    Vector3 wi{0, 0, 1};  ///< unit, towards the previous vertex
    /// Power relative to one light path, times the ratio of the cosines at the shading and geometric normals (camera
    /// paths shade with the former).
    SampledSpectrum power{0};
    int scatterings = 0;       ///< of the light path before this vertex
    bool isOneColour = false;  ///< only the first wavelength counts, as after SampledWavelengths::TerminateSecondary
};

/// Spatial hash grid of photons. Query results are in deterministic order.
class PhotonMap {
  public:
    /// Takes groups of photons, numbered group after group. Queries use this radius.
    void Build(std::vector<std::vector<Photon>> &groups, Float radius) {
        Clear();
        size_t count = 0;
        for (const std::vector<Photon> &group : groups) count += group.size();
        radius_ = radius;
        perWidth_ = 1 / (2 * double(radius));
        if (count == 0) return;
        begins_.assign(std::bit_ceil(count) + 1, 0);
        // Stable counting sort.
        for (const std::vector<Photon> &group : groups)
            for (const Photon &photon : group) ++begins_[BucketOf(CellOf(photon.p)) + 1];
        for (size_t i = 1; i < begins_.size(); ++i) begins_[i] += begins_[i - 1];
        photons_.resize(count);
        std::vector<uint32_t> next(begins_.begin(), begins_.end() - 1);
        for (std::vector<Photon> &group : groups) {
            for (const Photon &photon : group) photons_[next[BucketOf(CellOf(photon.p))]++] = photon;
            group = {};
        }
    }
    void Clear() { *this = {}; }

    Float Radius() const { return radius_; }
    size_t Size() const { return photons_.size(); }
    /// Calls visit(photon) for every photon within the radius of `p`.
    void ForEachAround(const Point3 &p, auto &&visit) const;

  private:
    struct Cell {
        int64_t x, y, z;
        bool operator==(const Cell &) const = default;
    };
    /// Cells are as wide as the query sphere, which overlaps at most eight of them.
    Cell CellOf(double x, double y, double z) const {
        return {int64_t(std::floor(x * perWidth_)), int64_t(std::floor(y * perWidth_)),
                int64_t(std::floor(z * perWidth_))};
    }
    Cell CellOf(const Point3 &p) const { return CellOf(double(p.x), double(p.y), double(p.z)); }
    size_t BucketOf(const Cell &cell) const { return Hash(cell.x, cell.y, cell.z) & (begins_.size() - 2); }

    std::vector<Photon> photons_;   ///< sorted by bucket, then by number
    std::vector<uint32_t> begins_;  ///< of each bucket; one more entry at the end; empty without photons
    Float radius_ = 0;
    double perWidth_ = 0;
};

void PhotonMap::ForEachAround(const Point3 &p, auto &&visit) const {
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
                    // Buckets may hold photons of several cells, including other visited ones.
                    if (LengthSquared(photon.p - p) <= radius_ * radius_ && CellOf(photon.p) == cell) visit(photon);
                }
            }
}

}  // namespace pbrt
