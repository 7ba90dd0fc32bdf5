#include "pbrt/integrators/photon_map.h"

#include <bit>

#include "pbrt/math/rng.h"

namespace pbrt {

size_t PhotonMap::BucketOf(const Cell &cell) const { return Hash(cell.x, cell.y, cell.z) & (begins_.size() - 2); }

void PhotonMap::Build(std::vector<std::vector<Photon>> &groups, Float radius) {
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

}  // namespace pbrt
