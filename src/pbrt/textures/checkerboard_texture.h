#pragma once
#include <optional>

#include "pbrt/textures/basic_textures.h"

namespace pbrt {

/// Square wave (+1 on [0, 1), -1 on [1, 2), ...) filtered by a tent of half-width `radius` around x.
Float FilteredSquareWave(Float x, Float radius);

/// Weight of the second texture, in [0, 1]: 0 in the cell at the origin, alternating, filtered over the footprint.
class CheckerPattern {
  public:
    explicit CheckerPattern(TextureMapping2D mapping) : mapping_(std::move(mapping)) {}
    explicit CheckerPattern(PointMapping mapping) : mapping_(std::move(mapping)) {}
    Float SecondWeight(const TextureContext &ctx) const;

  private:
    std::variant<TextureMapping2D, PointMapping> mapping_;
};

template <class Base, class V, class... Lambda>
class CheckerboardTexture final : public Base {
  public:
    using Ptr = std::shared_ptr<const Base>;
    CheckerboardTexture(CheckerPattern pattern, Ptr first, Ptr second)
        : pattern_(std::move(pattern)), first_(std::move(first)), second_(std::move(second)) {}
    V Evaluate(const TextureContext &ctx, const Lambda &...lambda) const override {
        return BlendTextures<V>(pattern_.SecondWeight(ctx), *first_, *second_, ctx, lambda...);
    }
    bool UsesFootprint() const override { return true; }

  private:
    CheckerPattern pattern_;
    Ptr first_, second_;
};

}  // namespace pbrt
