#include "pbrt/core/params.h"
#include "pbrt/materials/material_params.h"
#include "pbrt/math/rng.h"

namespace pbrt {
namespace {

/// Chooses one of two materials per point, the second with probability `amount`. A hash of point, direction and
/// `pairId` makes repeated evaluations of a hit consistent.
class MixMaterial final : public Material {
  public:
    /// `pairId` identifies the operands independently of memory addresses.
    MixMaterial(std::array<MaterialPtr, 2> materials, FloatInput amount, uint64_t pairId)
        : materials_(std::move(materials)), amount_(std::move(amount)), pairId_(pairId) {
        for (size_t i = 0; i < 2; ++i) {
            if (materials_[i]->IsMix()) mixes_[i] = static_cast<const MixMaterial *>(materials_[i].get());
            if (mixes_[i]) depth_ = std::max(depth_, mixes_[i]->depth_ + 1);
        }
    }
    Bsdf GetBsdf(const SurfacePoint &point, SampledWavelengths &lambda) const override {
        return Resolve(point)->GetBsdf(point, lambda);
    }
    void PerturbShading(SurfacePoint &point) const override { Resolve(point)->PerturbShading(point); }
    const Material *Resolve(const SurfacePoint &point) const override {
        const MixMaterial *mix = this;
        for (;;) {
            const size_t chosen = mix->Choose(point);
            if (!mix->mixes_[chosen]) return mix->materials_[chosen].get();
            mix = mix->mixes_[chosen];
        }
    }
    bool IsMix() const override { return true; }
    /// Nesting depth; 1 if neither operand is a mix.
    int Depth() const { return depth_; }

  private:
    size_t Choose(const SurfacePoint &point) const {
        const Float amount = amount_(point);
        if (amount <= 0) return 0;
        if (amount >= 1) return 1;
        return HashFloat(point.p, point.wo, pairId_) < amount ? 1 : 0;
    }

    std::array<MaterialPtr, 2> materials_;
    std::array<const MixMaterial *, 2> mixes_{};  ///< operands that are mixes, else null
    FloatInput amount_;
    uint64_t pairId_;
    int depth_ = 1;
};

struct MixParams {
    std::span<const std::string> materials;
    FloatTextureParam amount{Float(0.5)};
    void Describe(auto &&v) {
        v("materials", materials, "two material names");
        v("amount", amount, "probability of the second material");
    }
};

uint64_t HashText(const std::string &text) {
    uint64_t h = Hash(uint64_t(text.size()));
    for (char c : text) h = Hash(h, c);
    return h;
}

MaterialPtr MakeMix(const MixParams &p, const ParamSet &set, MaterialContext &context) {
    const std::span<const std::string> names = p.materials;
    if (names.size() != 2)
        throw set.Error("materials", "\"string materials\" takes two names of materials, found {}.", names.size());
    std::array<MaterialPtr, 2> materials;
    for (size_t i = 0; i < 2; ++i) {
        materials[i] = set.At("materials", [&] { return context.named(names[i]); });
        if (!materials[i]) throw set.Error("materials", "there is no material \"{}\" here.", Abbreviate(names[i]));
        if (materials[i]->IsInterface())
            throw set.Error("materials", "\"{}\" is an interface, which cannot be mixed.", names[i]);
    }
    context.usesFootprint = false;
    const FloatInput amount = Inputs(context)(p.amount);
    const bool needsFootprint =
        context.usesFootprint || materials[0]->NeedsFootprint() || materials[1]->NeedsFootprint();
    auto mix =
        std::make_shared<MixMaterial>(std::move(materials), amount, Hash(HashText(names[0]), HashText(names[1])));
    mix->SetNeedsFootprint(needsFootprint);
    if (mix->Depth() > kMaxNesting)
        throw set.Error("materials", "mixes are nested more than {} deep here.", kMaxNesting);
    return mix;
}

}  // namespace

void AddMix(MaterialTable &table) { table.Add<MixParams>("mix", "", MakeMix); }

}  // namespace pbrt
