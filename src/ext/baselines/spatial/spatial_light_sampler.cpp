#include "ext/baselines/spatial/spatial_light_sampler.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "pbrt/core/effective_params_text.h"
#include "pbrt/core/log.h"
#include "pbrt/integrators/registry.h"
#include "pbrt/math/low_discrepancy.h"

namespace ext {
namespace {
constexpr uint64_t kStream = 0x7370617469616cull;  ///< decorrelates the shifts from other uses of the seed

Float Shifted(Float u, Float shift) {
    Float v = u + shift;
    return std::min(v < 1 ? v : v - 1, OneMinusEpsilon);
}
}  // namespace

SpatialLightSampler::SpatialLightSampler(const LightTable &lights, const SpatialParams &params)
    : VoxelLightSampler(params.meshlights ? lights.ByLight() : lights.ByComponent()), lights_(lights), params_(params) {
    points_.resize(params.samples);
    for (size_t i = 0; i < points_.size(); ++i)
        points_[i] = {.place = {RadicalInverse(2, i), RadicalInverse(3, i), RadicalInverse(5, i)},
                      .uMember = RadicalInverse(13, i),
                      .uLight = {RadicalInverse(7, i), RadicalInverse(11, i)}};
}

void SpatialLightSampler::Prepare(PrepareContext &context) {
    if (groups_.Size() <= 1) return;
    const auto start = std::chrono::steady_clock::now();
    PrepareVoxels(context, params_.voxels);
    auto work = double(grid_.BorderSize()) * double(groups_.Size()) * params_.samples;
    if (work > 3e8)
        LogWarning(
            "spatial: the distributions over {} lights take about {:.1e} light samples, {} for every "
            "voxel that a path enters for the first time.",
            groups_.Size(), work, groups_.Size() * points_.size());
    prepareSeconds_ = SecondsSince(start);
}

std::vector<double> SpatialLightSampler::UnshadowedContributions(uint32_t voxel) const {
    Rng rng(Hash(kStream, seed_, voxel));
    Vector3 shiftPlace{rng.Uniform(), rng.Uniform(), rng.Uniform()};
    Float shiftMember = rng.Uniform();
    Point2 shiftLight = rng.Uniform2();
    std::vector<double> mean(groups_.Size(), 0.0);
    for (const VoxelPoint &point : points_) {
        LightSampleContext from;  // no normals: a point in space
        Vector3 place(Shifted(point.place.x, shiftPlace.x), Shifted(point.place.y, shiftPlace.y),
                      Shifted(point.place.z, shiftPlace.z));
        from.p = grid_.PointIn(voxel, place);
        Float uMember = Shifted(point.uMember, shiftMember);
        Point2 u(Shifted(point.uLight.x, shiftLight.x), Shifted(point.uLight.y, shiftLight.y));
        for (uint32_t g = 0; g < mean.size(); ++g) {
            LightId light = groups_.SampleLight(g, uMember);
            std::optional<LightLiSample> sample =
                lights_[light].SampleLi(from, u, SampledWavelengths::WholeRange(), true);
            if (!sample || !sample->L || !(sample->pdf > 0)) continue;
            // Le G / p (area) equals Le / p (solid angle) without a receiver cosine.
            const double value = RootMeanSquare(sample->L) / (double(sample->pdf) * double(groups_.ShareOf(light)));
            if (std::isfinite(value)) mean[g] += value;
        }
    }
    for (double &m : mean) m /= double(points_.size());
    return mean;
}

std::vector<double> SpatialLightSampler::Weights(uint32_t voxel) const {
    std::vector<double> f = UnshadowedContributions(voxel);
    double minimum = std::accumulate(f.begin(), f.end(), 0.0) / double(f.size()) * double(params_.floor);
    for (double &v : f) v = std::max(v, minimum);
    return f;
}

void SpatialLightSampler::Report(nlohmann::ordered_json &report) const {
    report["parameters"] = EffectiveParamsText(params_);
    GroupLightSampler::Report(report);
    cdfs_.Report(report, prepareSeconds_);
    report["bytes"] = cdfs_.Bytes() + points_.capacity() * sizeof(VoxelPoint);
}

void SpatialLightSampler::Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const {
    uint32_t strongest = 0;
    Float share = groups_.Size() > 0 ? 1 / Float(groups_.Size()) : 0;
    if (IsPrepared()) {
        std::span<const uint32_t> cdf = Cdf(query.p);
        for (uint32_t g = 1; g < cdf.size(); ++g)
            if (FixedCdfPMF(cdf, g) > FixedCdfPMF(cdf, strongest)) strongest = g;
        share = FixedCdfPMF(cdf, strongest);
    }
    values.push_back({"voxel", double(grid_.Index(query.p)), true});
    values.push_back({"strongest group", double(strongest), true});
    values.push_back({"share of the strongest group", double(share), false});
}

std::string SpatialLightSampler::DescribeStructure() const {
    if (!IsPrepared()) return {};
    return fmt::format(
        "{}{} of {} voxels filled, {} groups of lights in each, {} KB\n"
        "{} points and {} light samples a voxel, {:.3f} s of thread time to fill them\n",
        grid_.Describe(), cdfs_.Filled(), cdfs_.Size(), groups_.Size(), cdfs_.Bytes() / 1000, points_.size(),
        points_.size() * groups_.Size(), cdfs_.FillThreadSeconds());
}

}  // namespace ext

void register_spatial(pbrt::PluginRegistry &registry) {
    using namespace ext;
    registry.Add<SpatialLightSampler, SpatialParams>(
        "spatial", "Unshadowed contribution per voxel, as pbrt-v3 (Noh, Choi, Moon 2023, Eq. 3).");
}
