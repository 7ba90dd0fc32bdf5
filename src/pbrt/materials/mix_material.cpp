#include "pbrt/materials/mix_material.h"

#include <algorithm>

#include "pbrt/math/rng.h"

namespace pbrt {

MixMaterial::MixMaterial(std::array<MaterialPtr, 2> materials, FloatInput amount, uint64_t pairId)
    : materials_(std::move(materials)), amount_(std::move(amount)), pairId_(pairId) {
    for (size_t i = 0; i < 2; ++i) {
        mixes_[i] = dynamic_cast<const MixMaterial *>(materials_[i].get());
        if (mixes_[i]) depth_ = std::max(depth_, mixes_[i]->depth_ + 1);
    }
}

size_t MixMaterial::Choose(const SurfacePoint &point) const {
    Float amount = amount_(point);
    if (amount <= 0) return 0;
    if (amount >= 1) return 1;
    return HashFloat(point.p, point.wo, pairId_) < amount ? 1 : 0;
}

const Material *MixMaterial::Resolve(const SurfacePoint &point) const {
    const MixMaterial *mix = this;
    for (;;) {
        size_t chosen = mix->Choose(point);
        if (!mix->mixes_[chosen]) return mix->materials_[chosen].get();
        mix = mix->mixes_[chosen];
    }
}

}  // namespace pbrt
